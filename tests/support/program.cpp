// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/program.h"

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <nlohmann/json.hpp>

#include "tests/support/catch.h"
#include "tests/support/paths.h"

namespace lockstep::testing {

namespace fs = std::filesystem;

const std::string kRunnerFolder = std::string(paths::kBuild) + "/output/runner";
// Where another program is tried in the tests of this one (tests/mutants/random), it is called instead.
const std::string kCalled = std::getenv("LOCKSTEP_PROGRAM") ? std::getenv("LOCKSTEP_PROGRAM") : paths::kProgram;
const std::string kFourBar = std::string(paths::kScenes) + "/four_bar.json";
const std::string kArm = R"("bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}], )";
const std::string kHinge = R"("name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0])";

Called shell(const std::string& line) {
  fs::create_directories(kRunnerFolder);
  const std::string command = "cd '" + kRunnerFolder + "' && PATH='" + fs::path(kCalled).parent_path().string() +
                              "':\"$PATH\" LOCKSTEP_OUTPUT='" + kRunnerFolder +
                              "' && export PATH LOCKSTEP_OUTPUT && { " + line + "\n} 2>&1";
  Called result;
  std::FILE* pipe = popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::array<char, 4096> part;
  for (std::size_t n; (n = std::fread(part.data(), 1, part.size(), pipe)) > 0;) result.text.append(part.data(), n);
  const int status = pclose(pipe);
  result.exit = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

Called call(const std::string& words, const std::string& before) {
  return shell(before + " '" + kCalled + "' " + words);
}

void check_refused(const Called& called, int exit, const std::vector<std::string>& words) {
  INFO(called.text);
  CHECK(called.exit == exit);
  for (const std::string& word : words) {
    INFO(word);
    CHECK(contains(called.text, word));
  }
}

std::string sample(const std::string& name) { return "'" + std::string(paths::kScenes) + "/" + name + ".json'"; }

nlohmann::json json_of(const std::string& words) {
  const Called called = call(words);
  INFO(called.text);
  REQUIRE(called.exit == 0);
  return nlohmann::json::parse(called.text);
}

std::string scene_file(const std::string& name, const std::string& members) {
  fs::create_directories(kRunnerFolder);
  const std::string path = kRunnerFolder + "/" + name + ".json";
  std::ofstream(path) << "{\"lockstep\": 1,\n" << members << "\n}\n";
  return path;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string value_of(const std::string& text, const std::string& label) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find_first_not_of(' '), after = begin + label.size();
    if (begin == std::string::npos || line.compare(begin, label.size() + 2, label + "  ") != 0) continue;
    return line.substr(line.find_first_not_of(' ', after));
  }
  return "";
}

std::string row_of(const std::string& text, const std::string& first) {
  std::istringstream cells(value_of(text, first));
  std::string row = first;
  for (std::string word; cells >> word;) row += " " + word;
  return row == first ? "" : row;
}

}  // namespace lockstep::testing
