// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/tools.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <boost/dll/runtime_symbol_info.hpp>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

#include <lockstep/error.h>
#include "framework/foundation/support/child.h"
#include "framework/tools/program/options.h"
#include "framework/tools/program/terminal.h"

namespace lockstep {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSimulate = "Simulate", kAnalyse = "Analyse", kCompare = "Compare methods",
                           kLook = "Look up", kConvert = "Convert and extend";
constexpr Verb kVerbs[] = {
    {"run", "", kSimulate, "Simulate a scene; write a CSV file and a picture"},
    {"resume", "", kSimulate, "Continue a run from its checkpoint"},
    {"report", "", kSimulate, "Simulate a scene and write one HTML file: animation, plots, settings"},
    {"sweep", "sweep", kSimulate, "Run a scene many times with varied values; one table row per run"},
    {"find", "sweep", kSimulate, "Find the value of a number of a scene at which a formula of its run reaches a value"},
    {"optimize", "sweep", kSimulate, "Find numbers of a scene for which a formula of its run is least or largest"},
    {"sensitivity", "sweep", kSimulate,
     "Estimate derivatives of formulas of a run, and of frequencies, by numbers of its scene"},
    {"demo", "", kSimulate, "Show a moving four-bar in the browser; write its scene and results to a folder"},
    {"check", "", kAnalyse, "Assemble a scene; report degrees of freedom and redundant constraints"},
    {"assemble", "analyses", kAnalyse, "Assemble the start of a scene; report which bodies move and how far"},
    {"statics", "analyses", kAnalyse, "Find the static equilibrium: poses, reactions, stability"},
    {"kinematics", "analyses", kAnalyse, "Compute the motion of a fully driven scene, without integration"},
    {"inverse", "analyses", kAnalyse, "Compute drive forces and reactions of a fully driven scene (inverse dynamics)"},
    {"modes", "analyses", kAnalyse, "Compute natural frequencies, damping ratios and mode shapes"},
    {"linearize", "analyses", kAnalyse, "Compute A, B, C, D of the linearised equations with named inputs and outputs"},
    {"explain", "analyses", kAnalyse, "List the loads on a body, or the effect of a joint or force, at one time"},
    {"matrices", "analyses", kAnalyse, "Write mass, damping, stiffness, Jacobian and right-hand sides at one time"},
    {"advise", "measuring", kCompare, "Find the cheapest method and setting for a given error"},
    {"chart", "measuring", kCompare, "Draw error against CPU time for all methods and settings"},
    {"atlas", "measuring", kCompare, "Map the accuracy of each method over two numbers of a scene"},
    {"list", "", kLook, "List joints, laws, forces, integrators, solvers or findings"},
    {"describe", "", kLook, "Describe a type, a key, a finding, or a parameter of a scene"},
    {"schema", "", kLook, "Print the JSON Schema of scene files, or of results (--json)"},
    {"reference", "", kLook, "Print the reference of scene files, or of findings, in Markdown"},
    {"man", "", kLook, "Print the manual page"},
    {"completion", "", kLook, "Print the completion script of a shell"},
    {"import", "import", kConvert, "Convert a robot in URDF to a scene"},
    {"new-plugin", "", kConvert, "Create the folder of a plugin: source, CMake file, test, scene"},
    {"plugins list", "", kConvert, "List the plugins of the search path and the types that they add"},
};

std::string file_of(std::string_view program) {
  if (const char* folder = std::getenv("LOCKSTEP_EXEC_PATH"); folder != nullptr && *folder != 0)
    return fmt::format("{}/lockstep-{}", folder, program);
  const std::string own = boost::dll::program_location().string();
  return (fs::path(own).parent_path().parent_path() / "libexec/lockstep/lockstep-").string().append(program);
}

}  // namespace

std::span<const Verb> verbs() { return kVerbs; }

const Verb* verb_of(std::string_view name) {
  const auto found = std::ranges::find(kVerbs, name, &Verb::name);
  return found == std::end(kVerbs) ? nullptr : found;
}

std::optional<int> call_tool(int argc, const char* const* argv) {
  const bool completes = argc > 2 && std::string_view(argv[1]) == "complete";
  const std::string_view verb = completes ? argv[2] : argc > 1 ? argv[1] : "";
  if (verb.empty() || verb.starts_with('-') || verb.find('/') != verb.npos) return {};
  const bool certifies = verb == "run" && !completes && std::any_of(argv + 2, argv + argc, [](const char* word) {
                           return std::string_view(word).starts_with("--certify");
                         });
  const Verb* known = verb_of(certifies ? "chart" : verb);
  const auto own = {"complete", "plugins", "plugin-answer"};  // words that are no command
  if (known != nullptr ? known->program.empty() : completes || std::ranges::find(own, verb) != own.end()) return {};
  const std::string program(known != nullptr ? known->program : verb);
  std::vector<char*> words;
  for (int k = 0; k < argc; ++k) words.push_back(const_cast<char*>(argv[k]));
  words.push_back(nullptr);
  if (known == nullptr) words.erase(words.begin() + 1);  // of a foreign program: as git calls one
  std::signal(SIGXFSZ, SIG_DFL);                         // as it was before run_program()
  const std::string file = file_of(program);
  execv(file.c_str(), words.data());
  const int why = errno;
  execvp(("lockstep-" + program).c_str(), words.data());
  if (known == nullptr) return {};
  if (completes) return kExitOk;
  const std::string state = why == ENOENT ? fmt::format("which is neither '{}' nor on the PATH", file)
                                          : fmt::format("but '{}' cannot be started: {}", file, std::strerror(why));
  tell_error(
      fmt::format("{} needs the program lockstep-{}, {}; build it (cmake --build build/release --target "
                  "lockstep_{}), or install the package lockstep",
                  certifies ? "--certify" : "'" + std::string(verb) + "'", program, state, program));
  return kExitUsage;
}

std::string ask_tools(const char* question) {
  std::string answers;
  std::string_view last;  // those of a program are adjacent
  for (const Verb& verb : kVerbs) {
    const std::string file = file_of(verb.program);
    if (verb.program.empty() || std::exchange(last, verb.program) == verb.program || !fs::exists(file)) continue;
    const auto [status, text] = run_child({file, question});
    if (status != 0) throw FileError("'" + file + "' cannot print its part; build or install it again");
    answers += text;
  }
  return answers;
}

}  // namespace lockstep
