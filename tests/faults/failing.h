// SPDX-License-Identifier: BSD-3-Clause
// What the tests of faults share: a scene, the program with a call that fails, and what tables must be like.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace failing {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

inline const std::string kFailing = std::string(paths::kBuild) + "/test_plugins/failing_calls.so";
inline const std::string kFolder = kRunnerFolder + "/faults";
// The exit codes that a page has (framework/docs/scenes.md).
inline const std::set<int> kDocumented = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 130};
const char* const kOld = "t,old\n0,1\n";  // a table of an earlier run

inline std::string arm_scene(const std::string& name, const std::string& run) {
  fs::create_directories(kFolder);
  const std::string path = kFolder + "/" + name + ".json";
  std::ofstream(path) << R"({"lockstep": 1, "gravity": [0,-9.81,0],
    "bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0]}], "run": {)"
                      << run << "}}\n";
  return path;
}
const char* const kShort = R"("until": 0.05, "output": 0.01, "integrator": "rk4", "step": 0.01, "record": ["arm.x"])";

inline std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline const std::string kCalls[] = {"malloc", "write", "fsync",
                                     "rename"};  // whose numbers counts_of() tells, in this order

// The program with a call that fails: "malloc:17".
inline Called with_failing(const std::string& call_of, const std::string& words) {
  return call(words, "PATH=/nowhere LOCKSTEP_FAIL='" + call_of + "' LD_PRELOAD='" + kFailing + "'");
}

// Calls of each kind that these words make.
inline std::vector<long> counts_of(const std::string& words) {
  const std::string file = kFolder + "/counts-" + std::to_string(::getpid());  // other tests count at the same time
  fs::remove(file);
  const Called whole = call(words, "PATH=/nowhere LOCKSTEP_FAIL_COUNT='" + file + "' LD_PRELOAD='" + kFailing + "'");
  INFO(whole.text);
  REQUIRE(whole.exit == 0);
  std::ifstream in(file);
  std::vector<long> counts;
  for (long n; in >> n;) counts.push_back(n);
  REQUIRE(counts.size() == 4);
  return counts;
}

// Whole rows only, each as long as the header. `killed`: the system may have cut the last write, as it does with a long one
// between two pages of memory when SIGKILL arrives.
inline void check_rows(const std::string& file, bool killed = false) {
  const std::string text = bytes_of(file);
  if (text.empty()) return;
  INFO(file << ":\n" << text.substr(text.size() < 200 ? 0 : text.size() - 200));
  const std::size_t end = text.find_last_of('\n');
  if (end == std::string::npos) return;
  const auto commas = [](const std::string& line) { return std::count(line.begin(), line.end(), ','); };
  const auto whole = commas(text.substr(0, text.find('\n')));
  std::size_t at = 0;
  long torn = 0;
  for (std::size_t next; (next = text.find('\n', at)) != std::string::npos; at = next + 1)
    torn += commas(text.substr(at, next - at)) != whole ? 1 : 0;
  CHECK(torn == 0);
  if (!killed) CHECK(text.back() == '\n');
}

}  // namespace failing
