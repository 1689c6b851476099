// SPDX-License-Identifier: BSD-3-Clause
// The program lockstep-analyses: commands that analyse a mechanism.
#include "framework/tools/commands/tool_verbs.h"

namespace lockstep {
namespace {

constexpr const char* kModesFooter =
    R"(The state must be an equilibrium or a steady rotation; what accelerates, and how much, is said where it is none. Modes are in
space, also of a scene that moves in a plane, unless its key "planar" or --planar names one.
A shape is scaled so that its largest rotation, or translation over the length of the mechanism, is 1.

With gravity along its arm the pendulum of the samples hangs.

Example:
  lockstep modes samples/scenes/pendulum.json --set gravity.0=9.81 --set gravity.1=0)";

constexpr const char* kLinearizeFooter =
    R"(x' = A x + B u, y = C x + D u. The states are displacements of bodies from the state, one for each freedom, then their rates.

Example:
  lockstep linearize samples/scenes/mass_spring_damper_fast.json --set bodies.mass_c.velocity.0=0 --set bodies.mass_c.position.0=0 --inputs push_c --outputs mass_c.x,mass_c.ax)";

constexpr Option kAt{"--at", "T", "the instant, s, to which the scene is run; default 0, its assembled start"};

// What kinematics and inverse take.
Options driven() {
  return join({scene_options(),
               {kJson,
                {"--until", "T", "the last instant, s; default: that of the scene's run"},
                {"--output", "H", "interval of the poses, s; default: the scene's, or a hundredth of the whole"},
                {"--record", "FILE.csv", "the CSV file; default: <scene>.csv in LOCKSTEP_OUTPUT or here"},
                {"--quiet", "", "print errors only"}}});
}

// What modes and linearize take.
Options motion() {
  return join({scene_options(),
               {kAt,
                kJson,
                {"--spin", "X,Y,Z",
                 "angular velocity of the axes in which a steady rotation rests, rad/s; default: found from the state"},
                {"--frozen", "", "take the coefficients of an instant that is neither an equilibrium nor steady"}}});
}

std::vector<Command> commands() {
  return {
      {"mobility", "", "", join({scene_options(), {kJson}}), mobility_command,
       "Counted at the assembled start. `lockstep check` says the same, and what a run makes of the scene.\n\n"
       "Example:\n  lockstep mobility samples/scenes/four_bar.json --full"},
      {"assemble", "", "",
       join({scene_options(),
             {kJson,
              {"--branches", "N", "look from N random starts for all ways in which a driven scene fits together"},
              Option{"--within", "D",
                     "end with 11 where a body is moved farther than D from where the scene puts it, turns times the "
                     "length of the mechanism; default: if assembly warns of the start"}
                  .without("--branches")}}),
       assemble_command, "Example:\n  lockstep assemble samples/scenes/four_bar.json"},
      {"statics", "", "",
       join({scene_options(),
             {kJson,
              {"--at", "T", "the instant at which laws and drives are taken, s; default 0"},
              {"--nearest", "", "take the equilibrium that is met first, stable or not"},
              Option{"--all", "N", "look from N random starts for all equilibria, unstable ones too"}.without(
                  "--nearest"),
              Option{"--vary", "NAME=...",
                     "NAME=a:b:n or NAME=v1,v2,...: the path over a parameter, one CSV row each, from the equilibrium "
                     "before"}
                  .repeated(),
              {"--record", "FILE.csv", "write poses and reactions as CSV"}}}),
       statics_command,
       "Newton's method goes downhill, from far away too; where it fails, dynamic relaxation goes on. Velocities are "
       "zero, drives hold their coordinates.\n\n"
       "Example:\n  lockstep statics samples/scenes/double_pendulum.json"},
      {"kinematics", "", "", driven(), kinematics_command,
       "Masses are not needed. A scene with too few or too many drives is refused, with the coordinates to drive or "
       "the "
       "drives to release.\n\nExample:\n  lockstep kinematics samples/scenes/four_bar.json --until 0.2"},
      {"inverse", "", "", driven(), inverse_command,
       "Columns: those of the scene, then every drive and every reaction.\n\n"
       "Example:\n  lockstep inverse samples/scenes/four_bar.json --until 0.2"},
      {"explain", "", "",
       join({scene_options(),
             {{"thing", "THING", "a body, link or force by its name; default: every body"},
              kJson,
              {"--at", "T", "the instant, s, to which the scene is run; default 0"}}}),
       explain_command, "Example:\n  lockstep explain samples/scenes/four_bar.json coupler --at 0.1"},
      {"modes", "", "",
       join({motion(),
             {{"--count", "N", "the N lowest; default: all of up to 1200 unknown velocities, the lowest 20 of more"},
              {"--csv", "FILE.csv", "one row per mode, with its shape"},
              {"--report", "FILE.html", "one HTML file in which the mechanism swings in each mode"}}}),
       modes_command, kModesFooter},
      {"linearize", "", "",
       join({motion(),
             {Option{"--inputs", "A,B",
                     "driven links (A, or A.rz of several drives: value, rate and second rate), forces (motor, pad.x), "
                     "laws (rope.length, table.translation.x)"},
              Option{"--outputs", "A,B", "channels, as `lockstep check SCENE --channels` lists them"},
              {"--csv", "FILE.csv", "one table: rows x' and y, columns x and u"}}}),
       linearize_command, kLinearizeFooter},
      {"matrices", "", "",
       join({scene_options(),
             {kAt,
              kJson,
              {"--out", "DIR", "folder for M, D, K and J as Matrix Market, and rows.csv and unknowns.csv"}}}),
       matrices_command,
       "M a + J^T lambda = f, J a = c.\n\nExample:\n  lockstep matrices samples/scenes/four_bar.json --at 0.1 --out "
       "four_bar"}};
}

}  // namespace
}  // namespace lockstep

int main(int argc, char* argv[]) { return lockstep::run_program(lockstep::commands, false, argc, argv); }
