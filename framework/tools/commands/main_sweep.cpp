// SPDX-License-Identifier: BSD-3-Clause
// The program lockstep-sweep: a scene run many times.
#include "framework/tools/commands/tool_commands.h"

int main(int argc, char* argv[]) {
  return lockstep::run_program([] { return std::vector{lockstep::sweep_command()}; }, false, argc, argv);
}
