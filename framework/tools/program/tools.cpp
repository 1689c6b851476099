// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/tools.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <boost/dll/runtime_symbol_info.hpp>
#include <csignal>
#include <cstdlib>
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

constexpr Tool kTools[] = {
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
    {"import", "import", kExtend, "Read a robot in URDF and write it as a scene"},
};

std::string file_of(const std::string& program) {
  if (const char* folder = std::getenv("LOCKSTEP_EXEC_PATH"); folder != nullptr && *folder != 0)
    return std::string(folder) + "/lockstep-" + program;
  const std::string own = boost::dll::program_location().string();
  return (fs::path(own).parent_path().parent_path() / "libexec/lockstep/lockstep-").string() + program;
}

bool is_own(std::string_view verb) {
  return verb == "complete" || verb == "plugins" || verb == "plugin-answer" ||
         std::ranges::any_of(own_commands(), [&](const Command& c) { return c.name == verb; });
}

}  // namespace

std::span<const Tool> tools() { return kTools; }

const Tool* tool_of(std::string_view verb) {
  const auto found = std::ranges::find(kTools, verb, &Tool::verb);
  return found == std::end(kTools) ? nullptr : found;
}

std::string_view help_of(const Command& command) {
  const Tool* tool = tool_of(command.name);
  return command.help.empty() && tool != nullptr ? tool->help : command.help;
}
std::string_view group_of(const Command& command) {
  const Tool* tool = tool_of(command.name);
  return command.group.empty() && tool != nullptr ? tool->group : command.group;
}

std::optional<int> call_tool(int argc, const char* const* argv) {
  const bool completes = argc > 2 && std::string_view(argv[1]) == "complete";
  const std::string_view verb = completes ? argv[2] : argc > 1 ? argv[1] : "";
  if (verb.empty() || verb.starts_with('-') || verb.find('/') != verb.npos) return {};
  const bool certifies = verb == "run" && !completes && std::any_of(argv + 2, argv + argc, [](const char* word) {
                           return std::string_view(word).starts_with("--certify");
                         });
  const Tool* tool = certifies ? tool_of("chart") : tool_of(verb);
  if (tool == nullptr && (completes || is_own(verb))) return {};
  const std::string program = tool != nullptr ? tool->program : std::string(verb);
  std::vector<char*> words;
  for (int k = 0; k < argc; ++k) words.push_back(const_cast<char*>(argv[k]));
  words.push_back(nullptr);
  if (tool == nullptr) words.erase(words.begin() + 1);  // of a program of another's: as git calls one
  std::signal(SIGXFSZ, SIG_DFL);                        // as it was before run_program()
  execv(file_of(program).c_str(), words.data());
  execvp(("lockstep-" + program).c_str(), words.data());
  if (tool == nullptr) return {};
  if (completes) return kExitOk;
  tell(
      fmt::format("lockstep: {} is in the program lockstep-{}, which is neither '{}' nor on the PATH; build it "
                  "(cmake --build build/release --target lockstep_{}), or install the package lockstep\n",
                  certifies ? "--certify" : "'" + std::string(verb) + "'", program, file_of(program), program));
  return kExitUsage;
}

std::string ask_tools(const char* question) {
  std::string answers;
  std::string_view last;  // those of a program stand together
  for (const Tool& tool : kTools) {
    const std::string file = file_of(tool.program);
    if (std::exchange(last, tool.program) == tool.program || !fs::exists(file)) continue;
    const auto [status, text] = run_child({file, question});
    if (status != 0) throw FileError("'" + file + "' cannot print its part; build or install it anew");
    answers += text;
  }
  return answers;
}

}  // namespace lockstep
