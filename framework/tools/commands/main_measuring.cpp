// SPDX-License-Identifier: BSD-3-Clause
// The program lockstep-measuring: commands that measure methods.
#include "framework/tools/commands/tool_verbs.h"

namespace lockstep {
namespace {

constexpr const char* kChartFooter =
    R"(Each combination goes from coarse to fine settings, cheapest next run first, until its error stops falling, it
costs a hundred times what another needs for the same error, or the time is spent. Errors are the largest over the
history at 101 instants, against the tightest run of one method; a second method shows how good that reference is.
Every integrator, in the form of the scene, comes to an error of a thousandth before finer runs and other forms have their
turn, as far as half of the time allows. A run counts only if all finer runs of its combination stay within twice its error. "<=": no coarser run missed.

Example:
  lockstep chart samples/scenes/four_bar.json --budget 60s --out charts
  lockstep chart samples/scenes/chain_10.json --integrators dopri5,dop853 --formulations omega)";

constexpr const char* kAtlasFooter =
    R"(NAME is any number of the scene, as in `lockstep sweep --help`: run.step, run.tolerance, run.stabilization.alpha,
forces.spring.stiffness, a parameter. NAME=a:b:n are n values evenly, NAME=a:b:n:log evenly in the logarithm. The first
--vary is the x axis. Each method has a map. A run works, is inaccurate, is wrong (and its energy balance, its drift, a
turn of more than 1 rad in a step or singular positions passed with plain stages say so, or nothing does), or stops with
an error. Runs are compared with a tight run of the same mechanism; settings of the run make no difference to that. A black line is the largest stable step of a method with fixed steps, by linear
theory at the start. The CSV file has a row for every run, with the reason where it stopped.

Example:
  lockstep atlas samples/scenes/mass_spring_damper.json --vary run.step=1e-3:3:30:log --vary forces.spring_a.stiffness=1:1e4:20:log --integrators rk4,semi_implicit_euler,radau5)";

constexpr Option kIntegrators{"--integrators", "A,B",
                              "only these, with keys if needed: rk4,dopri5:fixed=true; default: all"};
constexpr Option kUntil{"--until", "T", "end of the runs, s"};
constexpr Option kBudget{"--budget", "T", "CPU time for all runs together; default 60 s"};
constexpr Option kFolder{"--out", "DIR", "folder for CSV and pictures; default: LOCKSTEP_OUTPUT or here"};

// What chart and advise take.
Options benchmark() {
  return join(
      {scene_options(),
       {kIntegrators,
        Option{"--formulations", "A,B",
               "only these: omega, quaternion, joint, auto; default: all of these that the mechanism allows"}
            .among(kFormulations),
        Option{"--stabilizations,--stabilisations", "A,B", "only these: project, baumgarte, none; default: all"}.among(
            kStabilizations),
        {"--solvers", "A,B", "only these; default: all of `lockstep list solvers`"},
        {"--separately", "",
         "vary one of the four at a time, the others as in the scene: faster than every combination"},
        {"--tolerances", "COARSE:FINE", "range for adaptive integrators; default 1:1e-12"},
        {"--steps", "COARSE:FINE", "range for fixed steps, s; default: a hundredth of the run and 2^14 times less"},
        kUntil,
        kBudget,
        {"--report", "FILE.html", "one HTML file that shows each run as a point, by any two columns"},
        {"--quiet", "", "do not print each run"},
        kJson}});
}

std::vector<Command> commands() {
  return {
      {"chart", "", "",
       join({benchmark(),
             {kFolder,
              {"--caption", "TEXT", "the last line of the pictures; default: version, date and machine; '': none"}}}),
       chart_command, kChartFooter},
      {"advise", "", "",
       join({benchmark(),
             {{"--error", "E", "largest error allowed over the whole run, SI units; default 1e-6"},
              Option{"--of", "WHAT", "kind of error: position (m), velocity (m/s), energy (J), reaction (N)"}.among(
                  "position,velocity,energy,reaction")}}),
       advise_command,
       "Measured like `lockstep chart`, only as far as the answer needs. Ends with 1 if nothing met the error.\n\n"
       "Example:\n  lockstep advise samples/scenes/double_pendulum.json --error 1e-6 --until 2"},
      {"atlas", "", "",
       join({scene_options(),
             {Option{"--vary", "NAME=...", "NAME=a:b:n, NAME=a:b:n:log or NAME=v1,v2,...; twice: x axis, y axis"}
                  .needed()
                  .repeated(),
              Option{"--of", "WHAT", "what is drawn: status (default), error (m), energy (imbalance, relative)"}.among(
                  "status,error,energy"),
              kIntegrators,
              Option{"--stabilizations,--stabilisations", "A,B",
                     "these: project, baumgarte, none; default: the scene's, or baumgarte where its gains vary"}
                  .among(kStabilizations),
              Option{"--formulation", "F", "unknowns, as in `lockstep run --help`"}.among(kFormulations),
              {"--step", "H", "fixed step, or the largest step of an adaptive integrator, s"},
              kUntil,
              {"--error", "E", "largest error that works, relative to the largest displacement; default 0.01"},
              kBudget,
              kJobs,
              kFolder,
              kJson,
              {"--quiet", "", "no progress"}}}),
       atlas_command, kAtlasFooter},
      {"run", "", "Compute the motion of a scene, and certify it", run_options(), certified_run_command}};
}

}  // namespace
}  // namespace lockstep

int main(int argc, char* argv[]) { return lockstep::run_program(lockstep::commands, false, argc, argv); }
