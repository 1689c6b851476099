// The program lockstep-analyses: verbs that analyse a mechanism.
#include <CLI/CLI.hpp>

#include "framework/tools/commands/tool_verbs.h"

namespace lockstep {
namespace {

void add_mobility(CLI::App& verb, Arguments& a) {
  add_scene(verb, a);
  add_json(verb, a);
}

void add_assemble(CLI::App& verb, Arguments& a) {
  add_scene(verb, a);
  add_json(verb, a);
  CLI::Option* branches = add(verb, "--branches", a.branches, "N",
                              "look from N random starts for all ways in which a driven scene fits together");
  add(verb, "--within", a.within, "D",
      "end with 11 where a body is moved farther than D from where the scene puts it, turns times the length of the "
      "mechanism; default: if assembly warns of the start")
      ->excludes(branches);
}

void add_statics(CLI::App& verb, Arguments& a) {
  add_scene(verb, a);
  add_json(verb, a);
  add(verb, "--at", a.at, "T", "the instant at which laws and drives are taken, s; default 0");
  CLI::Option* nearest = verb.add_flag("--nearest", a.nearest, "take the equilibrium that is met first, stable or not");
  add(verb, "--all", a.all, "N", "look from N random starts for all equilibria, unstable ones too")->excludes(nearest);
  add_each(verb, "--vary", a.vary, "NAME=...",
           "NAME=a:b:n or NAME=v1,v2,...: the path over a parameter, one CSV row each, from the equilibrium before");
  add(verb, "--record", a.record, "FILE.csv", "write poses and reactions as CSV");
}

void add_driven(CLI::App& verb, Arguments& a) {
  add_scene(verb, a);
  add_json(verb, a);
  add(verb, "--until", a.until, "T", "the last instant, s; default: that of the scene's run");
  add(verb, "--output", a.interval, "H", "interval of the poses, s; default: the scene's, or a hundredth of the whole");
  add(verb, "--record", a.record, "FILE.csv", "the CSV file; default: <scene>.csv in LOCKSTEP_OUTPUT or here");
  verb.add_flag("--quiet", a.quiet, "print errors only");
}

void add_explain(CLI::App& verb, Arguments& a) {
  add_scene(verb, a);
  add(verb, "thing", a.name, "THING", "a body, link or force by its name; default: every body");
  add_json(verb, a);
  add(verb, "--at", a.at, "T", "the instant, s, to which the scene is run; default 0");
}

void add_instant(CLI::App& verb, Arguments& a) {
  add_scene(verb, a);
  add(verb, "--at", a.at, "T", "the instant, s, to which the scene is run; default 0, its assembled start");
}

void add_motion(CLI::App& verb, Arguments& a) {
  add_instant(verb, a);
  add_json(verb, a);
  add(verb, "--spin", a.spin, "X,Y,Z",
      "angular velocity of the axes in which a steady rotation rests, rad/s; default: found from the state");
  verb.add_flag("--frozen", a.frozen, "take the coefficients of an instant that is neither an equilibrium nor steady");
}

void add_modes(CLI::App& verb, Arguments& a) {
  add_motion(verb, a);
  add(verb, "--count", a.count, "N",
      "the N lowest; default: all of up to 1200 unknown velocities, the lowest 20 of more");
  add(verb, "--csv", a.csv, "FILE.csv", "one row per mode, with its shape");
  add(verb, "--report", a.report, "FILE.html", "one HTML file in which the mechanism swings in each mode");
}

constexpr const char* kModesFooter =
    R"(The state must be an equilibrium or a steady rotation; what accelerates, and how much, is said where it is none. Modes are in
space, also of a scene that moves in a plane, unless its key "planar" or --planar names one.
A shape is scaled so that its largest rotation, or translation over the length of the mechanism, is 1.

With gravity along its arm the pendulum of the samples hangs.

Example:
  lockstep modes samples/scenes/pendulum.json --set gravity.0=9.81 --set gravity.1=0)";

void add_linearize(CLI::App& verb, Arguments& a) {
  add_motion(verb, a);
  add_names(verb, "--inputs", a.inputs,
            "driven links (A, or A.rz of several drives: value, rate and second rate), forces (motor, pad.x), laws "
            "(rope.length, table.translation.x)");
  add_names(verb, "--outputs", a.outputs, "channels, as `lockstep check SCENE --channels` lists them");
  add(verb, "--csv", a.csv, "FILE.csv", "one table: rows x' and y, columns x and u");
}

constexpr const char* kLinearizeFooter =
    R"(x' = A x + B u, y = C x + D u. The states are displacements of bodies from the state, one for each freedom, then their rates.

Example:
  lockstep linearize samples/scenes/mass_spring_damper_fast.json --set bodies.mass_c.velocity.0=0 --set bodies.mass_c.position.0=0 --inputs push_c --outputs mass_c.x,mass_c.ax)";

void add_matrices(CLI::App& verb, Arguments& a) {
  add_instant(verb, a);
  add_json(verb, a);
  add(verb, "--out", a.out, "DIR", "folder for M, D, K and J as Matrix Market, and rows.csv and unknowns.csv");
}

constexpr Verb kVerbs[] = {
    {"mobility", "", add_mobility, mobility_command,
     "Counted at the assembled start. `lockstep check` says the same, and what a run makes of the scene.\n\n"
     "Example:\n  lockstep mobility samples/scenes/four_bar.json --full"},
    {"assemble", "", add_assemble, assemble_command, "Example:\n  lockstep assemble samples/scenes/four_bar.json"},
    {"statics", "", add_statics, statics_command,
     "Newton's method goes downhill, from far away too; where it fails, dynamic relaxation goes on. Velocities are "
     "zero, drives hold their coordinates.\n\n"
     "Example:\n  lockstep statics samples/scenes/double_pendulum.json"},
    {"kinematics", "", add_driven, kinematics_command,
     "Masses are not needed. A scene with too few or too many drives is refused, with the coordinates to drive or the "
     "drives to release.\n\nExample:\n  lockstep kinematics samples/scenes/four_bar.json --until 0.2"},
    {"inverse", "", add_driven, inverse_command,
     "Columns: those of the scene, then every drive and every reaction.\n\n"
     "Example:\n  lockstep inverse samples/scenes/four_bar.json --until 0.2"},
    {"explain", "", add_explain, explain_command,
     "Example:\n  lockstep explain samples/scenes/four_bar.json coupler --at 0.1"},
    {"modes", "", add_modes, modes_command, kModesFooter},
    {"linearize", "", add_linearize, linearize_command, kLinearizeFooter},
    {"matrices", "", add_matrices, matrices_command,
     "M a + J^T lambda = f, J a = c.\n\nExample:\n  lockstep matrices samples/scenes/four_bar.json --at 0.1 --out "
     "four_bar"},
};

}  // namespace
}  // namespace lockstep

int main(int argc, char* argv[]) { return lockstep::run_program({lockstep::kVerbs}, argc, argv); }
