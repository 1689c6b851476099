// SPDX-License-Identifier: BSD-3-Clause
// What the pages show is true: their C++ compiles and runs, their scenes run, their commands and files exist.
#include "tests/pages/page.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include <lockstep/author/registry.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

namespace {

const std::string& folder() {
  static const std::string path = std::string(paths::kBuild) + "/output/runner/pages";
  return path;
}

const std::vector<Page>& pages() {
  static const std::vector<Page> all = read_pages(paths::kSource);
  return all;
}

const Page& page(const std::string& name) {
  for (const Page& each : pages())
    if (each.name == name) return each;
  throw std::runtime_error("no page " + name);
}

std::string file_text(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A folder in which programs and commands of the pages run: the samples are there, as in a clone.
void go_to_folder() {
  fs::create_directories(folder());
  const fs::path samples = fs::path(paths::kScenes).parent_path();
  if (!fs::exists(folder() + "/samples")) fs::create_directory_symlink(samples, folder() + "/samples");
  fs::current_path(folder());
}

Called in_folder(const std::string& line) { return shell("cd pages && " + line); }

std::string write_scene(const std::string& name, const Block& block) {
  std::ofstream(folder() + "/" + name) << block.text();
  return name;
}

const Block& first_scene(const Page& of) {
  for (const Block& block : of.blocks)
    if (block.is("json")) return block;
  throw std::runtime_error("no scene in " + of.name);
}

// -- commands

struct Command {
  std::string place, verb, rest;  // "run", "samples/scenes/four_bar.json --step 1e-3"
};

void add_command(const std::string& place, const std::string& line, std::vector<Command>& to) {
  static const std::regex command("(?:^|[ /])lockstep (plugins list|[a-z][a-z-]*)([^|>#&]*)");
  std::smatch found;
  if (std::regex_search(line, found, command)) to.push_back({place, found[1], found[2]});
}

// In code spans that begin with the program's name, and in blocks of the shell.
std::vector<Command> commands() {
  std::vector<Command> all;
  for (const Page& of : pages()) {
    for (const Excerpt& span : of.spans)
      if (span.text.starts_with("lockstep ")) add_command(of.place(span.line), span.text, all);
    for (const Block& block : of.blocks) {
      if (block.language != "sh") continue;
      std::istringstream lines(block.text());
      for (std::string line; std::getline(lines, line);) add_command(of.place(block.line), line, all);
    }
  }
  return all;
}

std::string help_of(const std::string& verb) {
  static std::map<std::string, std::string> helps;
  std::string& help = helps[verb];
  if (help.empty()) {
    const Called asked = call(verb + " --help");
    help = asked.exit == 0 ? asked.text : "no such verb";
  }
  return help;
}

std::vector<std::string> words_of(const std::string& text, const char* pattern) {
  const std::regex word(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator i(text.begin(), text.end(), word), end; i != end; ++i) found.push_back((*i)[1]);
  return found;
}

// Whether it needs nothing but what is in the folder. A chart takes a minute.
bool complete(const Command& command) {
  static const std::set<std::string> verbs = {"run",     "check",   "assemble", "sweep",     "statics", "kinematics",
                                              "inverse", "explain", "modes",    "linearize", "matrices"};
  const std::vector<std::string> scenes = words_of(command.rest, "([^ ]+\\.json)");
  return verbs.count(command.verb) > 0 && scenes.size() == 1 && fs::exists(folder() + "/" + scenes[0]) &&
         command.rest.find_first_of("${") == std::string::npos;
}

// -- tables

// The code spans in the first column of the table whose head begins so.
std::vector<std::string> first_column(const Page& of, const std::string& head) {
  auto line = std::find_if(of.lines.begin(), of.lines.end(), [&](const std::string& l) { return l.starts_with(head); });
  REQUIRE(line != of.lines.end());
  std::vector<std::string> all;
  for (; line != of.lines.end() && line->starts_with("|"); ++line)
    for (const std::string& name : words_of(line->substr(0, line->find('|', 1)), "`([^`]+)`")) all.push_back(name);
  return all;
}

// Each registered name is in a code span of the page, and the table's first column has no other names.
void compare(const std::string& name, const std::string& head, const std::vector<std::string>& registered) {
  const Page& of = page(name);
  for (const std::string& type : registered) {
    INFO(name << " does not name " << type);
    CHECK(std::any_of(of.spans.begin(), of.spans.end(), [&](const Excerpt& span) { return span.text == type; }));
  }
  for (const std::string& type : first_column(of, head)) {
    INFO(name << " names " << type);
    CHECK(std::count(registered.begin(), registered.end(), type) > 0);
  }
}

}  // namespace

TEST_CASE("C++ of the pages runs", "[pages]") {
  go_to_folder();
  REQUIRE_FALSE(kExamples.empty());
  for (const Example& example : kExamples) {
    DYNAMIC_SECTION(example.place) { example.run(); }
  }
}

TEST_CASE("scenes of the pages run", "[pages]") {
  for (const Page& of : pages()) {
    const std::string place = folder_of(of, "scenes");
    for (const Block& block : of.blocks) {
      if (!block.is("json")) continue;
      const std::string file = block.file().empty() ? "scene_" + std::to_string(block.line) + ".json" : block.file();
      std::ofstream(kRunnerFolder + "/" + place + "/" + file) << block.text();
      const bool runs = block.text().find("\"until\"") != std::string::npos;
      const Called called = call_in(place, std::string(runs ? "lockstep run " : "lockstep check ") + file);
      INFO(of.place(block.line) << "\n" << called.text);
      CHECK(called.exit == 0);
    }
  }
}

TEST_CASE("the scene and the program of README make the same table", "[pages]") {
  go_to_folder();
  const Page& readme = page("README.md");
  write_scene("pendulum.json", first_scene(readme));
  REQUIRE(in_folder("lockstep run pendulum.json --record scene.csv").exit == 0);
  const auto program = std::find_if(kExamples.begin(), kExamples.end(),
                                    [](const Example& e) { return std::string(e.place).starts_with("README.md:"); });
  REQUIRE(program != kExamples.end());
  program->run();
  const Table a = read_csv("scene.csv"), b = read_csv("pendulum.csv");
  REQUIRE(a.n_columns() == b.n_columns());
  for (std::size_t k = 0; k < a.n_columns(); ++k) {
    INFO(a.columns()[k].name << " and " << b.columns()[k].name);
    CHECK(a.columns()[k].unit == b.columns()[k].unit);
    CHECK(a.columns()[k].values == b.columns()[k].values);
  }
}

TEST_CASE("commands of the pages are those of the program", "[pages]") {
  go_to_folder();
  write_scene("pendulum.json", first_scene(page("README.md")));
  int n_run = 0;
  for (const Command& command : commands()) {
    INFO(command.place << ": lockstep " << command.verb << command.rest);
    const std::string help = help_of(command.verb);
    CHECK(help != "no such verb");
    for (const std::string& option : words_of(command.rest, "(?:^| )(--[a-z-]+)")) {
      INFO(option);
      CHECK(contains(help, option));
    }
    if (!complete(command)) continue;
    const Called called = in_folder("lockstep " + command.verb + " " + command.rest);
    INFO(called.text);
    CHECK(called.exit == 0);
    ++n_run;
  }
  CHECK(n_run >= 3);
}

TEST_CASE("options that the pages mention exist", "[pages]") {
  std::string all;
  for (const std::string verb :
       {"run",     "report",     "demo",    "describe", "schema",      "import",     "check",       "assemble",
        "statics", "kinematics", "explain", "modes",    "linearize",   "matrices",   "atlas",       "chart",
        "advise",  "sweep",      "find",    "optimize", "sensitivity", "new-plugin", "plugins list"})
    all += help_of(verb);
  for (const Page& of : pages()) {
    if (of.name == "framework/CHANGELOG.md") continue;  // history
    for (const Excerpt& span : of.spans) {
      if (!span.text.starts_with("--")) continue;
      INFO(of.place(span.line) << ": " << span.text);
      CHECK(contains(all, span.text.substr(0, span.text.find_first_of(" ="))));
    }
  }
}

TEST_CASE("files that the pages mention exist", "[pages]") {
  static const std::regex file("((framework|integrators|motionlaws|plugins|samples|tests)/[^ <>`]*)( .*)?");
  for (const Page& of : pages()) {
    if (of.name == "framework/CHANGELOG.md" || of.name == "framework/README.md") continue;  // history; test `layout`
    for (const Excerpt& span : of.spans) {
      std::smatch found;
      if (!std::regex_match(span.text, found, file)) continue;
      INFO(of.place(span.line) << ": " << span.text);
      CHECK(fs::exists(paths::kSource + std::string("/") + found[1].str()));
    }
  }
}

TEST_CASE("every promise names tests that exist", "[pages]") {
  std::string tests;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(std::string(paths::kSource) + "/tests"))
    if (entry.path().extension() == ".cpp") tests += file_text(entry.path().string());
  int promises = 0;
  for (const std::string& line : page("framework/docs/promises.md").lines) {
    if (words_of(line, "^([0-9]+)\\. ").empty()) continue;
    ++promises;
    const std::vector<std::string> names = words_of(line, "\\*\"([^\"]+)\"\\*");
    INFO(line);
    CHECK_FALSE(names.empty());
    for (const std::string& name : names) {
      INFO("no test is called " << name);
      CHECK(tests.find("TEST_CASE(\"" + name + '"') != std::string::npos);
    }
  }
  CHECK(promises > 20);
}

TEST_CASE("the packages that README installs are those that the set-up looks for", "[pages]") {
  const std::string setup = file_text(paths::kSource + std::string("/framework/cmake/setup.sh"));
  const std::string readme = file_text(paths::kSource + std::string("/README.md"));
  const std::vector<std::string> lines = words_of(readme, "apt-get install ([^\n]*)");
  REQUIRE(lines.size() == 1);
  for (const std::string& package : words_of(lines[0], "([^ ]+)")) {
    INFO(package);
    CHECK(contains(setup, "need " + package + " "));
  }
}

TEST_CASE("the example of a mistake matches the program's output", "[pages]") {
  std::string text = file_text(paths::kScenes + std::string("/four_bar.json"));
  text.replace(text.find("\"slope\""), 7, "\"slop\"");
  std::string said;
  try {
    build_mechanism(scene_from_text(text, "four_bar.json"), builtin_registry());
  } catch (const SceneError& error) {
    said = error.what();
  }
  for (const char* name : {"README.md", "framework/docs/scenes.md"}) {
    int n_shown = 0;
    for (const Excerpt& span : page(name).spans) {
      if (!span.text.starts_with("four_bar.json:")) continue;
      CHECK(span.text == said);
      ++n_shown;
    }
    CHECK(n_shown == 1);
  }
}

TEST_CASE("the tables of the pages name every type", "[pages]") {
  const Registry registry = builtin_registry();
  std::vector<std::string> laws = registry.laws.names();
  for (const auto& more : {registry.translation_laws.names(), registry.rotation_laws.names()})
    laws.insert(laws.end(), more.begin(), more.end());
  compare("framework/docs/laws.md", "| law |", laws);
  compare("framework/docs/forces.md", "| force |", registry.forces.names());
  compare("framework/docs/integrators.md", "| name |", registry.integrators.names());
  compare("framework/docs/solvers.md", "| solver |", registry.solvers.names());
}

TEST_CASE("the page of findings is what the program writes", "[pages]") {
  INFO("write it anew: lockstep reference findings > framework/docs/findings.md");
  CHECK(file_text(paths::kSource + std::string("/framework/docs/findings.md")) ==
        in_folder("lockstep reference findings").text);
}

TEST_CASE("the reference of scenes is what the program writes", "[pages]") {
  const std::string written = in_folder("lockstep reference").text;
  INFO("write it anew: lockstep reference > framework/docs/reference.md");
  CHECK(file_text(paths::kSource + std::string("/framework/docs/reference.md")) == written);
}

TEST_CASE("the tables of the pages name classes and members that exist", "[pages]") {
  const std::string include = paths::kSource + std::string("/framework/include/lockstep");
  std::string headers;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(include))
    if (entry.is_regular_file()) headers += file_text(entry.path());
  struct Names {
    const char *page, *head, *before, *after;
  };
  for (const Names& n : {Names{"framework/docs/hosts_reference.md", "| type |", "class LOCKSTEP_API ", " "},
                         Names{"framework/docs/forces.md", "| facet |", "class LOCKSTEP_API ", " "},
                         Names{"framework/docs/forces.md", "| question |", "virtual double ", "("},
                         Names{"framework/docs/joints.md", "| member |", " ", ""}})
    for (const std::string& name : first_column(page(n.page), n.head)) {
      INFO(n.page << ": " << name);
      CHECK(contains(headers, n.before + name + n.after));
    }
}
