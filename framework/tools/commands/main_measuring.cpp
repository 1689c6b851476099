// The program lockstep-measuring: verbs that measure methods.
#include <CLI/CLI.hpp>

#include "framework/tools/commands/tool_verbs.h"

namespace lockstep {
namespace {

void add_benchmark(CLI::App& verb, Arguments& a) {
  add_scene(verb, a);
  add_names(verb, "--integrators", a.integrators,
            "only these, with keys if needed: rk4,dopri5:fixed=true; default: all");
  add_names(verb, "--formulations", a.formulations,
            "only these: omega, quaternion, joint, auto; default: all of these that the mechanism allows")
      ->check(CLI::IsMember(formulation_names()));
  add_names(verb, "--stabilizations,--stabilisations", a.stabilizations,
            "only these: project, baumgarte, none; default: all")
      ->check(CLI::IsMember(kStabilizations));
  add_names(verb, "--solvers", a.solvers, "only these; default: all of `lockstep list solvers`");
  verb.add_flag("--separately", a.separately,
                "vary one of the four at a time, the others as in the scene: faster than every combination");
  add(verb, "--tolerances", a.tolerances, "COARSE:FINE", "range for adaptive integrators; default 1:1e-12");
  add(verb, "--steps", a.steps, "COARSE:FINE",
      "range for fixed steps, s; default: a hundredth of the run and 2^14 times less");
  add(verb, "--until", a.until, "T", "end of the runs, s");
  add(verb, "--budget", a.budget, "T", "CPU time for all runs together; default 60 s");
  add(verb, "--report", a.report, "FILE.html", "one HTML file that shows each run as a point, by any two columns");
  verb.add_flag("--quiet", a.quiet, "do not print each run");
  add_json(verb, a);
}

void add_chart(CLI::App& verb, Arguments& a) {
  add_benchmark(verb, a);
  add(verb, "--out", a.out, "DIR", "folder for CSV and pictures; default: LOCKSTEP_OUTPUT or here");
  verb.add_option("--caption", a.caption, "the last line of the pictures; default: version, date and machine; '': none")
      ->type_name("TEXT");
}

constexpr const char* kChartFooter =
    R"(Each combination goes from coarse to fine settings, cheapest next run first, until its error stops falling, it
costs a hundred times what another needs for the same error, or the time is spent. Errors are the largest over the
history at 101 instants, against the tightest run of one method; a second method shows how good that reference is.
Every integrator, in the form of the scene, comes to an error of a thousandth before finer runs and other forms have their
turn, as far as half of the time allows. A run counts only if all finer runs of its combination stay within twice its error. "<=": no coarser run missed.

Example:
  lockstep chart samples/scenes/four_bar.json --budget 60s --out charts
  lockstep chart samples/scenes/chain_10.json --integrators dopri5,dop853 --formulations omega)";

void add_advise(CLI::App& verb, Arguments& a) {
  add_benchmark(verb, a);
  add(verb, "--error", a.error, "E", "largest error allowed over the whole run, SI units; default 1e-6");
  add(verb, "--of", a.of, "WHAT", "kind of error: position (m), velocity (m/s), energy (J), reaction (N)",
      {"position", "velocity", "energy", "reaction"});
}

constexpr const char* kAtlasFooter =
    R"(NAME is any number of the scene, as in `lockstep sweep --help`: run.step, run.tolerance, run.stabilization.alpha,
forces.spring.stiffness, a parameter. NAME=a:b:n are n values evenly, NAME=a:b:n:log evenly in the logarithm. The first
--vary is the x axis. Each method has a map. A run works, is inaccurate, is wrong (and its energy balance, its drift, a
turn of more than 1 rad in a step or singular positions passed with plain stages say so, or nothing does), or stops with
an error. Runs are compared with a tight run of the same mechanism; settings of the run make no difference to that. A black line is the largest stable step of a method with fixed steps, by linear
theory at the start. The CSV file has a row for every run, with the reason where it stopped.

Example:
  lockstep atlas samples/scenes/mass_spring_damper.json --vary run.step=1e-3:3:30:log --vary forces.spring_a.stiffness=1:1e4:20:log --integrators rk4,semi_implicit_euler,radau5)";

void add_atlas(CLI::App& verb, Arguments& a) {
  add_scene(verb, a);
  add_each(verb, "--vary", a.vary, "NAME=...", "NAME=a:b:n, NAME=a:b:n:log or NAME=v1,v2,...; twice: x axis, y axis")
      ->required();
  add(verb, "--of", a.of, "WHAT", "what is drawn: status (default), error (m), energy (imbalance, relative)",
      {"status", "error", "energy"});
  add_names(verb, "--integrators", a.integrators,
            "only these, with keys if needed: rk4,dopri5:fixed=true; default: all");
  add_names(verb, "--stabilizations,--stabilisations", a.stabilizations,
            "these: project, baumgarte, none; default: the scene's, or baumgarte where its gains vary")
      ->check(CLI::IsMember(kStabilizations));
  add(verb, "--formulation", a.formulation, "F", "unknowns, as in `lockstep run --help`", formulation_names());
  add(verb, "--step", a.step, "H", "fixed step, or the largest step of an adaptive integrator, s");
  add(verb, "--until", a.until, "T", "end of the runs, s");
  add(verb, "--error", a.error, "E", "largest error that works, relative to the largest displacement; default 0.01");
  add(verb, "--budget", a.budget, "T", "CPU time for all runs together; default 60 s");
  verb.add_option("--jobs", a.jobs, "threads that compute runs; default: the processors that the program may use")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  add(verb, "--out", a.out, "DIR", "folder for CSV and pictures; default: LOCKSTEP_OUTPUT or here");
  add_json(verb, a);
  verb.add_flag("--quiet", a.quiet, "no progress");
}

constexpr Verb kVerbs[] = {
    {"chart", "", add_chart, chart_command, kChartFooter},
    {"advise", "", add_advise, advise_command,
     "Measured like `lockstep chart`, only as far as the answer needs. Ends with 1 if nothing met the error.\n\n"
     "Example:\n  lockstep advise samples/scenes/double_pendulum.json --error 1e-6 --until 2"},
    {"atlas", "", add_atlas, atlas_command, kAtlasFooter},
    {"run", "Compute the motion of a scene, and certify it", add_run, certified_run_command, ""},
};

}  // namespace
}  // namespace lockstep

int main(int argc, char* argv[]) { return lockstep::run_program({lockstep::kVerbs}, argc, argv); }
