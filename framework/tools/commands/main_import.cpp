// The program lockstep-import: other formats as scenes.
#include <CLI/CLI.hpp>

#include "framework/tools/commands/tool_verbs.h"

namespace lockstep {
namespace {

void add_import(CLI::App& verb, Arguments& a) {
  add(verb, "file", a.scene, "FILE.urdf",
      "the robot; -: from standard input, as in `xacro robot.xacro | lockstep import -`")
      ->required();
  add(verb, "--out", a.out, "FILE.json", "the scene; default: standard output");
  verb.add_flag("--floating", a.floating, "the first link is not held; without it, it is fixed in the world");
}

constexpr Verb kVerbs[] = {
    {"import", "", add_import, import_command,
     "Limits become stops, damping becomes forces; what is left out (mimicry, friction) is named.\n\n"
     "Example:\n  lockstep import robot.urdf --out robot.json"},
};

}  // namespace
}  // namespace lockstep

int main(int argc, char* argv[]) { return lockstep::run_program({lockstep::kVerbs}, argc, argv); }
