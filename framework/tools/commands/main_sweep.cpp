// SPDX-License-Identifier: BSD-3-Clause
// The program lockstep-sweep: a scene run many times, for a table or for the values that it should have.
#include "framework/tools/commands/tool_commands.h"

int main(int argc, char* argv[]) {
  using namespace lockstep;
  const auto commands = [] {
    return std::vector{sweep_command(), find_command(), optimize_command(), sensitivity_command()};
  };
  return run_program(commands, false, argc, argv);
}
