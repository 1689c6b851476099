// SPDX-License-Identifier: BSD-3-Clause
// The programs that `lockstep` calls: lockstep-analyses analyses a mechanism, lockstep-measuring measures methods,
// lockstep-sweep runs a scene many times, lockstep-import reads other formats. Each is this file with its LOCKSTEP_TOOL.
#include "framework/tools/commands/tool_commands.h"

namespace {

std::vector<lockstep::Command> commands() {
  using namespace lockstep;
  const std::string_view tool = LOCKSTEP_TOOL;
  if (tool == "analyses")
    return {assemble_command(), statics_command(), kinematics_command(), inverse_command(),
            explain_command(),  modes_command(),   linearize_command(),  matrices_command()};
  if (tool == "measuring") return {chart_command(), advise_command(), atlas_command(), certify_command()};
  if (tool == "sweep") return {sweep_command(), find_command(), optimize_command(), sensitivity_command()};
  return {import_command()};
}

}  // namespace

int main(int argc, char* argv[]) { return lockstep::run_program(commands, false, argc, argv); }
