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

constexpr std::string_view kRun = "Run a mechanism", kLook = "Look at a scene", kAnalyse = "Analyse",
                           kCompare = "Compare and sweep", kExtend = "Extend and install";
constexpr Verb kVerbs[] = {
    {"run", "", kRun, "Compute the motion of a scene, write CSV and a picture"},
    {"resume", "", kRun, "Go on with a run from its checkpoint"},
    {"report", "", kRun,
     "Run a scene and write it as one HTML file: the mechanism in motion, its columns, its settings"},
    {"demo", "", kRun, "Show a moving four-bar in the browser, and leave its scene to play with"},
    {"check", "", kLook, "Read and build a scene; report its bodies, unknowns, rows and degrees of freedom"},
    {"list", "", kLook,
     "List the laws, links, forces, integrators and solvers that scenes may name; `list findings`: what may be found"},
    {"describe", "", kLook, "Print what a type, an object of a scene or a finding is, and which keys it takes"},
    {"schema", "", kLook, "Print the JSON Schema of scene files, for editors; or of what commands print with --json"},
    {"reference", "", kLook,
     "Print the reference of scenes as a page in Markdown: every object, type, key and unit; or that of findings"},
    {"mobility", "analyses", kAnalyse,
     "Tell how a scene can move, which of its rows are too many, and which reactions are not unique"},
    {"assemble", "analyses", kAnalyse, "Bring the start of a scene onto its constraints; report what moved how far"},
    {"statics", "analyses", kAnalyse,
     "Find where a scene rests under its loads; report poses, reactions and whether it stays there"},
    {"kinematics", "analyses", kAnalyse,
     "Follow a fully driven scene over time: positions, velocities, accelerations, without integration"},
    {"inverse", "analyses", kAnalyse,
     "Find the forces of the drives and all reactions of a fully driven scene over time, without integration"},
    {"explain", "analyses", kAnalyse,
     "Tell what acts on a body, what a link does and why it is redundant, what laws give, at one instant"},
    {"modes", "analyses", kAnalyse, "Frequencies, damping ratios and shapes about an equilibrium or a steady rotation"},
    {"linearize", "analyses", kAnalyse,
     "A, B, C, D of the linear equations about a state, with named inputs and outputs"},
    {"matrices", "analyses", kAnalyse,
     "Mass, damping, stiffness, jacobian and right sides at an instant, with the names of rows and columns"},
    {"chart", "measuring", kCompare,
     "Draw error against CPU time and evaluations for all integrators, formulations, stabilisations, solvers"},
    {"advise", "measuring", kCompare,
     "Measure which method and setting meets an error at the least cost; print how to use it"},
    {"atlas", "measuring", kCompare,
     "Draw where each method works and where it fails, over any two numbers of a scene"},
    {"sweep", "sweep", kCompare, "Run a scene many times with other values, one row per run"},
    {"new-plugin", "", kExtend,
     "Write the folder of a plugin: source, CMake file, test, scene; it builds and passes at once"},
    {"completion", "", kExtend,
     "Print the script by which a shell completes lines: verbs, options, names of the scene"},
    {"man", "", kExtend, "Print the manual page"},
    {"plugins list", "", kExtend, "Load each plugin of the search path; report what it brings"},
    {"import", "import", kExtend, "Read a robot in URDF and write it as a scene"},
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
  const auto own = {"complete", "plugins", "plugin-answer"};  // words that no verb is
  if (known != nullptr ? known->program.empty() : completes || std::ranges::find(own, verb) != own.end()) return {};
  const std::string program(known != nullptr ? known->program : verb);
  std::vector<char*> words;
  for (int k = 0; k < argc; ++k) words.push_back(const_cast<char*>(argv[k]));
  words.push_back(nullptr);
  if (known == nullptr) words.erase(words.begin() + 1);  // of a program of another's: as git calls one
  std::signal(SIGXFSZ, SIG_DFL);                        // as it was before run_program()
  const std::string file = file_of(program);
  execv(file.c_str(), words.data());
  const int why = errno;
  execvp(("lockstep-" + program).c_str(), words.data());
  if (known == nullptr) return {};
  if (completes) return kExitOk;
  const std::string state = why == ENOENT ? fmt::format("which is neither '{}' nor on the PATH", file)
                                          : fmt::format("but '{}' cannot be started: {}", file, std::strerror(why));
  tell(
      fmt::format("lockstep: {} is in the program lockstep-{}, {}; build it (cmake --build build/release --target "
                  "lockstep_{}), or install the package lockstep\n",
                  certifies ? "--certify" : "'" + std::string(verb) + "'", program, state, program));
  return kExitUsage;
}

std::string ask_tools(const char* question) {
  std::string answers;
  std::string_view last;  // those of a program stand together
  for (const Verb& verb : kVerbs) {
    const std::string file = file_of(verb.program);
    if (verb.program.empty() || std::exchange(last, verb.program) == verb.program || !fs::exists(file)) continue;
    const auto [status, text] = run_child({file, question});
    if (status != 0) throw FileError("'" + file + "' cannot print its part; build or install it anew");
    answers += text;
  }
  return answers;
}

}  // namespace lockstep
