// SPDX-License-Identifier: BSD-3-Clause
// The program lockstep-import: other formats as scenes.
#include "framework/tools/commands/tool_verbs.h"

namespace lockstep {
namespace {

std::vector<Command> commands() {
  return {
      {"import",
       "",
       "",
       {Option{"file", "FILE.urdf", "the robot; -: from standard input, as in `xacro robot.xacro | lockstep import -`"}
            .needed(),
        {"--out", "FILE.json", "the scene; default: standard output"},
        {"--floating", "", "the first link is not held; without it, it is fixed in the world"}},
       import_command,
       "Limits become stops, damping becomes forces; what is left out (mimicry, friction) is named.\n\n"
       "Example:\n  lockstep import robot.urdf --out robot.json"}};
}

}  // namespace
}  // namespace lockstep

int main(int argc, char* argv[]) { return lockstep::run_program(lockstep::commands, false, argc, argv); }
