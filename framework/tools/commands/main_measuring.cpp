// SPDX-License-Identifier: BSD-3-Clause
// The program lockstep-measuring: commands that measure methods.
#include "framework/tools/commands/tool_commands.h"

int main(int argc, char* argv[]) {
  using namespace lockstep;
  const auto commands = [] {
    return std::vector{chart_command(), advise_command(), atlas_command(), certify_command()};
  };
  return run_program(commands, false, argc, argv);
}
