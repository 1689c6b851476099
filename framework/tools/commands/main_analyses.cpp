// SPDX-License-Identifier: BSD-3-Clause
// The program lockstep-analyses: commands that analyse a mechanism.
#include "framework/tools/commands/tool_commands.h"

int main(int argc, char* argv[]) {
  using namespace lockstep;
  const auto commands = [] {
    return std::vector{assemble_command(), statics_command(), kinematics_command(), inverse_command(),
                       explain_command(),  modes_command(),   linearize_command(),  matrices_command()};
  };
  return run_program(commands, false, argc, argv);
}
