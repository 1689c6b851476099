// The verbs that run a scene, once or many times: their options.
#include <CLI/CLI.hpp>

#include "framework/tools/program/options.h"

namespace lockstep {
namespace {

void add_run(CLI::App& verb, Arguments& a) {
  add_settings(verb, a);
  CLI::Option* report =
      add(verb, "--report", a.report, "FILE.html", "one HTML file that shows the motion and the columns in a browser");
  CLI::Option* certify = verb.add_flag("--certify", a.certify,
                                       "repeat the run with a tighter tolerance and with a second method; report how "
                                       "many digits of each column agree; exit code 11 where not one digit of a "
                                       "column does");
  add(verb, "--budget", a.budget, "T", "CPU time for all runs of --certify together; default 60 s")->needs(certify);
  certify->excludes(add_run_outputs(verb, a));
  CLI::Option* checkpoint = add(
      verb, "--checkpoint", a.checkpoint, "FILE",
      "write all that the run holds to this file now and then, and when it is interrupted; `lockstep resume` goes on "
      "from there. It is removed when the run is done");
  checkpoint->excludes(certify)->excludes(report);
  add(verb, "--every", a.every, "T", "how often, by the clock; default 60 s")->needs(checkpoint);
}

void add_resume(CLI::App& verb, Arguments& a) {
  add(verb, "checkpoint", a.checkpoint, "FILE", "what `lockstep run --checkpoint` wrote")->required();
}

void add_report(CLI::App& verb, Arguments& a) {
  add_settings(verb, a);
  add(verb, "--out", a.report, "FILE.html", "the HTML file; default: beside the CSV, with its name");
  verb.add_flag("--open", a.open, "show it in the browser (xdg-open)");
  add_run_outputs(verb, a);
}

void add_demo(CLI::App& verb, Arguments& a) {
  add(verb, "--into", a.into, "DIR", "folder of its files; default: lockstep_demo in LOCKSTEP_OUTPUT or here");
  verb.add_flag("--no-open", a.no_open, "only write the files, open no browser");
}

constexpr const char* kSweepFooter =
    R"(NAME is a parameter of the scene, or a path into it: bodies.arm.mass, links.A.drive.law.slope, gravity.1, run.tolerance; an item of a
list is given by its name or by its number, counted from 0. Units are those of scenes: bodies.arm.mass=200g:1kg:5.
Several --vary make the full grid. Each run is one row: its number, the values, final, min and max of each recorded
column, the verdict on its energy with the imbalance, its largest violation, steps, CPU seconds, status. A run that
fails is a row with its reason, and the exit code is 1; 9 where a run did not conserve energy or drifted. In lanes the
energy is not judged where a law may move a link (--lanes off). Ctrl-C keeps the rows so far; --resume goes on.

Example:
  lockstep sweep pendulum.json --vary bodies.rod.rod.mass=1:5:100 --vary gravity.1=-9.81,-1.62 --record moon.csv
Runs are shared out to all processors that the program may use (--jobs); shards share them out to several machines.
With GNU parallel, eight shards (units without blanks):
  parallel lockstep sweep pendulum.json --vary bodies.rod.rod.mass=1:5:100 --quiet --shard {}/8 --record mass_{}.csv ::: $(seq 8)
Under Slurm, sbatch of a script with these lines:
  #SBATCH --array=1-8
  i=$SLURM_ARRAY_TASK_ID n=$SLURM_ARRAY_TASK_COUNT
  lockstep sweep pendulum.json --vary bodies.rod.rod.mass=1:5:100 --quiet --shard $i/$n --record mass_$i.csv
The shares have one header. One table in the order of the whole grid is made by
  awk 'FNR > 1 || NR == 1' mass_*.csv | sort -t , -k 1,1n > mass.csv)";

void add_sweep(CLI::App& verb, Arguments& a) {
  add_settings(verb, a);
  verb.add_option("--vary", a.vary, "NAME=a:b:n, n values evenly from a to b, or NAME=v1,v2,...; may be repeated")
      ->required()
      ->type_name("NAME=...")
      ->allow_extra_args(false);
  add(verb, "--shard", a.shard, "i/n", "only every n-th run, from the i-th on; i counts from 1");
  add(verb, "--record", a.record, "FILE.csv",
      "the CSV file; default: <scene>_sweep.csv or <scene>_sweep_<i>of<n>.csv, in LOCKSTEP_OUTPUT or here; -: standard "
      "output, and words to standard error");
  add(verb, "--report", a.report, "FILE.html",
      "one HTML file that shows each run as a point, by any two columns; with --histories a click shows its curves and "
      "its motion");
  add(verb, "--lanes", a.lanes, "MODE", "auto: eight runs at once if the mechanism is suited; off: one by one",
      {"auto", "off"});
  verb.add_option("--jobs", a.jobs,
                  "threads that compute runs; default: the processors that the program may use, 1 with --shard. Laws, "
                  "links and forces of plugins that share data among runs need --jobs 1")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  add(verb, "--histories", a.histories, "DIR", "folder for the columns of each run, <its number>.csv");
  add_headers(verb, a);
  CLI::Option* quiet = verb.add_flag("--quiet", a.quiet, "print errors only");
  CLI::Option* json = add_json(verb, a)->excludes(quiet);
  verb.add_flag("--resume", a.resume,
                "go on where the same sweep was interrupted or killed: the rows that are there stay")
      ->excludes(json);
}

void add_benchmark(CLI::App& verb, Arguments& a) {
  add_scene(verb, a);
  const auto list = [&](const char* names, std::vector<std::string>& to, const char* help) {
    return verb.add_option(names, to, help)->delimiter(',')->allow_extra_args(false)->type_name("A,B");
  };
  list("--integrators", a.integrators, "only these, with keys if needed: rk4,dopri5:fixed=true; default: all");
  list("--formulations", a.formulations,
       "only these: omega, quaternion, joint, auto; default: all of these that the mechanism allows")
      ->check(CLI::IsMember(formulation_names()));
  list("--stabilizations,--stabilisations", a.stabilizations, "only these: project, baumgarte, none; default: all")
      ->check(CLI::IsMember(kStabilizations));
  list("--solvers", a.solvers, "only these; default: all of `lockstep list solvers`");
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
  verb.add_option("--vary", a.vary, "NAME=a:b:n, NAME=a:b:n:log or NAME=v1,v2,...; twice: x axis, y axis")
      ->required()
      ->type_name("NAME=...")
      ->allow_extra_args(false);
  add(verb, "--of", a.of, "WHAT", "what is drawn: status (default), error (m), energy (imbalance, relative)",
      {"status", "error", "energy"});
  const auto list = [&](const char* names, std::vector<std::string>& to, const char* help) {
    return verb.add_option(names, to, help)->delimiter(',')->allow_extra_args(false)->type_name("A,B");
  };
  list("--integrators", a.integrators, "only these, with keys if needed: rk4,dopri5:fixed=true; default: all");
  list("--stabilizations,--stabilisations", a.stabilizations,
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

constexpr Verb kRunVerbs[] = {
    {"run", "Compute the motion of a scene, write CSV and a picture", add_run, run_command,
     "Example:\n  lockstep run samples/scenes/four_bar.json --integrator rk4 --step 1e-3 --record out.csv"},
    {"resume", "Go on with a run from its checkpoint", add_resume, resume_command,
     "The run has the command line and the folder that it was begun with, and equals one that was not interrupted, to "
     "the\n"
     "last bit. Scene, plugins and version must be the same.\n\n"
     "Example:\n  lockstep run samples/scenes/four_bar.json --until 10000 --checkpoint four_bar.checkpoint --every "
     "10s\n"
     "  lockstep resume four_bar.checkpoint"},
    {"report", "Run a scene and write it as one HTML file: the mechanism in motion, its columns, its settings",
     add_report, report_command,
     "What `lockstep run` writes is written too. The file needs no network and no other file.\n\n"
     "Example:\n  lockstep report samples/scenes/four_bar.json --open"},
    {"demo", "Show a moving four-bar in the browser, and leave its scene to play with", add_demo, demo_command,
     "Writes four_bar.json, .csv, .png, .svg and .html; a four_bar.json that is there already is shown as it is.\n\n"
     "Example:\n  lockstep demo"},
    {"sweep", "Run a scene many times with other values, one row per run", add_sweep, sweep_command, kSweepFooter},
    {"chart", "Draw error against CPU time and evaluations for all integrators, formulations, stabilisations, solvers",
     add_chart, chart_command, kChartFooter},
    {"advise", "Measure which method and setting meets an error at the least cost; print how to use it", add_advise,
     advise_command,
     "Measured like `lockstep chart`, only as far as the answer needs. Ends with 1 if nothing met the error.\n\n"
     "Example:\n  lockstep advise samples/scenes/double_pendulum.json --error 1e-6 --until 2"},
    {"atlas", "Draw where each method works and where it fails, over any two numbers of a scene", add_atlas,
     atlas_command, kAtlasFooter},
};

}  // namespace

std::span<const Verb> run_verbs() { return kRunVerbs; }

}  // namespace lockstep
