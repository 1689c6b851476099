// SPDX-License-Identifier: BSD-3-Clause
// What the pages show as output is what the program prints. LOCKSTEP_WRITE_PAGES=1 writes it into the pages instead.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "tests/pages/page.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

namespace {

// A command of a block "console", and the lines below it.
struct Shown {
  std::string command, output;
};

std::vector<Shown> shown_in(const Block& block) {
  std::vector<Shown> all;
  std::istringstream lines(block.text());
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("$ "))
      all.push_back({line.substr(2), ""});
    else if (!all.empty() && all.back().command.ends_with("\\"))
      all.back().command += "\n" + line;
    else if (!all.empty())
      all.back().output += line + "\n";
  }
  return all;
}

// Times of computing differ from run to run; round-off, last digits, steps at contacts and the runs of a search differ
// from processor to processor.
std::string comparable(const std::string& text) {
  static const std::regex time("(in [0-9]+ steps, )?computed in +[0-9.e-]+ m?s\\b|\\n +runs +[0-9]+\\n"), blanks(" +"),
      number("[0-9]+(\\.[0-9]+)?(e[-+]?[0-9]+)?"), progress(" +[0-9]+ % [^\\n]* s to go\\n");
  const std::string without = std::regex_replace(text, progress, "");  // a run that takes long prints it
  const std::string same = std::regex_replace(std::regex_replace(without, time, "computed"), blanks, " ");
  std::string all;
  auto end = same.begin();
  for (std::sregex_iterator i(same.begin(), same.end(), number), last; i != last; ++i) {
    const double x = std::strtod(i->str().c_str(), nullptr);
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.4g", x < 1e-9 ? 0 : x);
    all.append(end, (*i)[0].first).append(digits);
    end = (*i)[0].second;
  }
  return all.append(end, same.end());
}

std::string run_block(const Block& block, const std::string& folder) {
  std::string text;
  for (const Shown& each : shown_in(block)) {
    const std::string output = call_in(folder, each.command).text;
    text += "$ " + each.command + "\n";
    text += comparable(output) == comparable(each.output) ? each.output : output;  // times stay as they are
  }
  return text;
}

void write_page(const Page& of, const std::vector<std::string>& lines) {
  std::ofstream file(paths::kSource + std::string("/") + of.name);
  for (const std::string& line : lines) file << line << "\n";
}

}  // namespace

std::string lockstep::testing::folder_of(const Page& of, const std::string& purpose) {
  std::string name = purpose + "/" + of.name;
  std::replace(name.begin() + static_cast<std::ptrdiff_t>(purpose.size()) + 1, name.end(), '/', '_');
  const fs::path path = fs::path(kRunnerFolder) / name;
  fs::remove_all(path);
  fs::create_directories(path);
  fs::create_directory_symlink(fs::path(paths::kScenes).parent_path(), path / "samples");
  for (const Block& block : of.blocks)
    if (!block.file().empty() && (block.is("json") || block.is("text")))
      std::ofstream(path / block.file()) << block.text();
  return name;
}

Called lockstep::testing::call_in(const std::string& folder, const std::string& line) {
  return shell("unset LOCKSTEP_OUTPUT; cd " + folder + " && " + line);
}

TEST_CASE("outputs on the pages are what the program prints", "[pages]") {
  const bool write = std::getenv("LOCKSTEP_WRITE_PAGES") != nullptr;
  int n_blocks = 0;
  for (const Page& of : read_pages(paths::kSource)) {
    const std::string folder = folder_of(of, "outputs");
    std::vector<std::string> lines = of.lines;
    std::ptrdiff_t moved = 0;  // lines that blocks before this one gained
    for (const Block& block : of.blocks) {
      if (!block.file().empty() && (block.is("json") || block.is("text"))) {
        std::ofstream(kRunnerFolder + "/" + folder + "/" + block.file()) << block.text();
      }
      if (block.language != "console") continue;
      ++n_blocks;
      const std::string found = run_block(block, folder);
      if (!write) {
        INFO(of.place(block.line) << ": write it anew with LOCKSTEP_WRITE_PAGES=1");
        CHECK(found == block.text());
        continue;
      }
      std::vector<std::string> written;
      std::istringstream text(found);
      for (std::string line; std::getline(text, line);) written.push_back(line);
      const auto begin = lines.begin() + block.line + moved;
      const auto end = std::find(begin, lines.end(), "```");
      moved += static_cast<std::ptrdiff_t>(written.size()) - (end - begin);
      lines.insert(lines.erase(begin, end), written.begin(), written.end());
    }
    if (write && lines != of.lines) write_page(of, lines);
  }
  CHECK(n_blocks > 0);
}
