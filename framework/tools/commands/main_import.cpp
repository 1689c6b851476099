// SPDX-License-Identifier: BSD-3-Clause
// The program lockstep-import: other formats as scenes.
#include "framework/tools/commands/tool_commands.h"

int main(int argc, char* argv[]) {
  return lockstep::run_program([] { return std::vector{lockstep::import_command()}; }, false, argc, argv);
}
