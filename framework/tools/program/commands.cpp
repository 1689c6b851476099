// The command line: the verbs with their options, and the exit codes of errors.
#include "framework/tools/program/commands.h"

#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <map>
#include <new>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include <lockstep/version.h>
#include "framework/description/scene/describe.h"
#include "framework/foundation/support/thrown.h"
#include "framework/tools/program/complete.h"
#include "framework/tools/program/manual.h"
#include "framework/tools/program/terminal.h"

namespace lockstep {
namespace {

using Choices = std::vector<std::string>;
const Choices kStabilizations{"project", "baumgarte", "none"};

CLI::Option* add(CLI::App& verb, const char* name, std::string& to, const char* type, const std::string& help) {
  return verb.add_option(name, to, help)->type_name(type);
}
CLI::Option* add(CLI::App& verb, const char* name, std::string& to, const char* type, const std::string& help,
                 const Choices& choices) {
  return add(verb, name, to, type, help)->check(CLI::IsMember(choices));
}

CLI::Option* add_json(CLI::App& verb, Arguments& a) {
  return verb.add_flag("--json", a.json, "print the result as JSON, and nothing else");
}

void add_plugins(CLI::App& verb, Arguments& a) {
  verb.add_option("--plugin", a.plugins, "load a plugin, by name or path; may be given several times")
      ->type_name("P")
      ->allow_extra_args(false);
}

void add_scene(CLI::App& verb, Arguments& a) {
  add(verb, "scene", a.scene, "SCENE", "the scene file (JSON); -: from standard input")->required();
  add_plugins(verb, a);
  add(verb, "--planar", a.planar, "AXIS", "planar motion, by its normal; auto: where that is exact",
      {"off", "auto", "x", "y", "z"});
  verb.add_option("--set", a.set,
                  "NAME=VALUE: another value of a parameter (crank=\"120 mm\"), or of a path as in `lockstep sweep "
                  "--help`; may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  verb.add_flag("--allow-files", a.allow_files, "let the scene read files outside of its folder");
  verb.add_flag("--full", a.full, "no shortcuts: neither planar motion nor merged bodies nor coordinates of joints");
}

// What run and sweep share.
void add_settings(CLI::App& verb, Arguments& a) {
  add_scene(verb, a);
  add(verb, "--integrator", a.integrator, "N", "see `lockstep list integrators`; with keys: dopri5:fixed=true");
  CLI::Option* step = add(verb, "--step", a.step, "H", "fixed step, or the largest step of an adaptive integrator, s");
  add(verb, "--tolerance", a.tolerance, "T", "relative tolerance of adaptive integrators")->excludes(step);
  add(verb, "--until", a.until, "T", "end of the run, s");
  add(verb, "--formulation", a.formulation, "F",
      "unknowns: 6 velocities per body, the paper's 7 coordinates, or the coordinates of the joints; auto: of the "
      "joints "
      "where that can be, else omega",
      formulation_names());
  add(verb, "--stabilization", a.stabilization, "S", "constraint stabilisation", kStabilizations);
  add(verb, "--solver", a.solver, "N", "see `lockstep list solvers`");
}

// What a run writes beside its report.
void add_run_outputs(CLI::App& verb, Arguments& a) {
  add(verb, "--record", a.record, "FILE.csv",
      "the CSV file; default: <scene>.csv in LOCKSTEP_OUTPUT or here; -: standard output, and words to standard error");
  verb.add_flag("--no-picture", a.no_picture, "draw no picture beside the CSV file");
  CLI::Option* quiet =
      verb.add_flag("--quiet", a.quiet, "print errors only; energy is then not integrated and not judged, drift is");
  add_json(verb, a)->excludes(quiet);
}

void add_run(CLI::App& verb, Arguments& a) {
  add_settings(verb, a);
  add(verb, "--report", a.report, "FILE.html", "one HTML file that shows the motion and the columns in a browser");
  CLI::Option* certify = verb.add_flag("--certify", a.certify,
                                       "repeat the run with a tighter tolerance and with a second method; report how "
                                       "many digits of each column agree");
  add(verb, "--budget", a.budget, "T", "CPU time for all runs of --certify together; default 60 s")->needs(certify);
  add_run_outputs(verb, a);
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

void add_import(CLI::App& verb, Arguments& a) {
  add(verb, "file", a.scene, "FILE.urdf", "the robot")->required();
  add(verb, "--out", a.out, "FILE.json", "the scene; default: standard output");
  verb.add_flag("--floating", a.floating, "the first link is not held; without it, it is fixed in the world");
}

constexpr const char* kSweepFooter =
    R"(NAME is a parameter of the scene, or a path into it: bodies.arm.mass, links.A.drive.law.slope, gravity.1, run.tolerance; an item of a
list is given by its name or by its number, counted from 0. Units are those of scenes: bodies.arm.mass=200g:1kg:5.
Several --vary make the full grid. Each run is one row: its number, the values, final, min and max of each recorded
column, steps, CPU seconds, status. A run that fails is a row with its reason, and the exit code is 1. Ctrl-C keeps the
rows so far.

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
      "the CSV file; default: <scene>_sweep.csv or <scene>_sweep_<i>of<n>.csv, in LOCKSTEP_OUTPUT or here");
  add(verb, "--report", a.report, "FILE.html", "one HTML file that shows each run as a point, by any two columns");
  add(verb, "--lanes", a.lanes, "MODE", "auto: eight runs at once if the mechanism is suited; off: one by one",
      {"auto", "off"});
  verb.add_option("--jobs", a.jobs,
                  "threads that compute runs; default: the processors that the program may use, 1 with --shard. Laws, "
                  "links and forces of plugins that share data among runs need --jobs 1")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  add(verb, "--histories", a.histories, "DIR", "folder for the columns of each run, <its number>.csv");
  CLI::Option* quiet = verb.add_flag("--quiet", a.quiet, "print errors only");
  add_json(verb, a)->excludes(quiet);
}

// Which combinations are measured, and for how long.
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
}

constexpr const char* kChartFooter =
    R"(Each combination goes from coarse to fine settings, cheapest next run first, until its error stops falling, it
costs a hundred times what another needs for the same error, or the time is spent. Errors are the largest over the
history at 101 instants, against the tightest run of one method; a second method shows how good that reference is.
A run counts only if all finer runs of its combination stay within twice its error. "<=": no coarser run missed.

Example:
  lockstep chart samples/scenes/four_bar.json --budget 60s --out charts
  lockstep chart samples/scenes/chain_10.json --integrators dopri5,dop853 --formulations omega)";

void add_advise(CLI::App& verb, Arguments& a) {
  add_benchmark(verb, a);
  add(verb, "--error", a.error, "E", "largest error allowed over the whole run, SI units; default 1e-6");
  add(verb, "--of", a.of, "WHAT", "kind of error: position (m), velocity (m/s), energy (J), reaction (N)",
      {"position", "velocity", "energy", "reaction"});
}

void add_check(CLI::App& verb, Arguments& a) {
  add_scene(verb, a);
  add_json(verb, a);
  CLI::Option* channels =
      verb.add_flag("--channels", a.channels, "list every channel that the scene may record, with unit and meaning");
  add(verb, "--of", a.name, "NAME", "with --channels: only those of this body, marker, link or force")->needs(channels);
  verb.add_option("more", a.more_scenes, "further scenes")->type_name("SCENE");
}

void add_assemble(CLI::App& verb, Arguments& a) {
  add_scene(verb, a);
  add_json(verb, a);
  add(verb, "--branches", a.branches, "N",
      "look from N random starts for all ways in which a driven scene fits together");
}

void add_statics(CLI::App& verb, Arguments& a) {
  add_scene(verb, a);
  add_json(verb, a);
  add(verb, "--at", a.at, "T", "the instant at which laws and drives are taken, s; default 0");
  verb.add_flag("--nearest", a.nearest, "take the equilibrium that is met first, stable or not");
  add(verb, "--all", a.all, "N", "look from N random starts for all equilibria, unstable ones too");
  verb.add_option("--vary", a.vary,
                  "NAME=a:b:n or NAME=v1,v2,...: the path over a parameter, one CSV row each, from the equilibrium "
                  "before")
      ->type_name("NAME=...")
      ->allow_extra_args(false);
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

// What modes, linearize and matrices share: an instant of a scene.
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
}

constexpr const char* kModesFooter =
    R"(The state must be an equilibrium or a steady rotation; what accelerates, and how much, is said where it is none. Modes are in
space, also of a scene that moves in a plane, unless the scene has a key "planar" or --planar gives one.
A shape is scaled so that its largest rotation, or translation over the length of the mechanism, is 1.

Example (gravity along the arm, so that it hangs):
  lockstep modes samples/scenes/pendulum.json --set gravity.0=9.81 --set gravity.1=0)";

void add_linearize(CLI::App& verb, Arguments& a) {
  add_motion(verb, a);
  const auto list = [&](const char* name, std::vector<std::string>& to, const char* help) {
    verb.add_option(name, to, help)->delimiter(',')->allow_extra_args(false)->type_name("A,B");
  };
  list("--inputs", a.inputs,
       "driven links (A, or A.rz of several drives: value, rate and second rate) and forces with a magnitude");
  list("--outputs", a.outputs, "channels, as `lockstep check SCENE --channels` lists them");
  add(verb, "--csv", a.csv, "FILE.csv", "one table: rows x' and y, columns x and u");
}

constexpr const char* kLinearizeFooter =
    R"(x' = A x + B u, y = C x + D u. The states are displacements of bodies from the state, one for each freedom, then their rates.

Example:
  lockstep linearize arm.json --inputs motor --outputs hinge.angle_z,hinge.force_on_p_world_x --json)";

void add_matrices(CLI::App& verb, Arguments& a) {
  add_instant(verb, a);
  add_json(verb, a);
  add(verb, "--out", a.out, "DIR", "folder for M, D, K and J as Matrix Market, and rows.csv and unknowns.csv");
}

constexpr const char* kAtlasFooter =
    R"(NAME is any number of the scene, as in `lockstep sweep --help`: run.step, run.tolerance, run.stabilization.alpha,
forces.spring.stiffness, a parameter. NAME=a:b:n are n values evenly, NAME=a:b:n:log evenly in the logarithm. The first
--vary is the x axis. Each method has a map. A run works, is inaccurate, is wrong (and the energy balance or the drift
says so, or nothing does), or stops with an error. Runs are compared with a tight run of the same mechanism; settings of
the run make no difference to that. A black line is the largest stable step of a method with fixed steps, by linear
theory at the start. The CSV file has a row for every run, with the reason where it stopped.

Example:
  lockstep atlas samples/scenes/mass_spring_damper.json --vary run.step=1e-3:3:30:log     --vary forces.spring.stiffness=1:1e4:20:log --integrators rk4,semi_implicit_euler,radau5)";

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

void add_list(CLI::App& verb, Arguments& a) {
  add(verb, "shelf", a.name, "SHELF", "only one of them", {"links", "laws", "forces", "integrators", "solvers"});
  add_plugins(verb, a);
  add_json(verb, a);
}

void add_describe(CLI::App& verb, Arguments& a) {
  add(verb, "name", a.name, "NAME",
      "a name of `lockstep list`; an object of scenes: body, marker, link, force, event, "
      "run, ...; a key; or orientation, axis, law, formula, unit, channel, ...")
      ->required();
  add_plugins(verb, a);
  add_json(verb, a);
}

void add_new_plugin(CLI::App& verb, Arguments& a) {
  add(verb, "kind", a.kind, "KIND", "link, coupling, law, force or integrator",
      {"link", "coupling", "law", "force", "integrator"})
      ->required();
  add(verb, "name", a.name, "NAME", "its name in scenes, and its folder's: small letters, digits and _")->required();
  add(verb, "--into", a.into, "DIR", "the parent of its folder; default: here");
}

void add_plugins_list(CLI::App& verb, Arguments& a) {
  verb.add_flag("--why", a.why, "report everything: folders, files, builds, and why a plugin is refused");
  add_json(verb, a);
}

void add_completion(CLI::App& verb, Arguments& a) {
  add(verb, "shell", a.kind, "SHELL", "bash or zsh", {"bash", "zsh"})->required();
}

int completion_command(const Arguments& args) {
  fmt::print("{}", completion_script(args.kind));
  return kExitOk;
}

int man_command(const Arguments& args) {
  fmt::print("{}", manual_page(*args.line));
  return kExitOk;
}

void add_nothing(CLI::App&, Arguments&) {}

/// A verb of the program.
struct Verb {
  const char* name;
  const char* help;
  void (*add_options)(CLI::App&, Arguments&);
  int (*run)(const Arguments&);
  const char* footer;
};

constexpr Verb kVerbs[] = {
    {"run", "Compute the motion of a scene, write CSV and a picture", add_run, run_command,
     "Example:\n  lockstep run samples/scenes/four_bar.json --integrator rk4 --step 1e-3 --record out.csv"},
    {"report", "Run a scene and write it as one HTML file: the mechanism in motion, its columns, its settings",
     add_report, report_command,
     "What `lockstep run` writes is written too. The file needs no network and no other file.\n\n"
     "Example:\n  lockstep report samples/scenes/four_bar.json --open"},
    {"demo", "Show a moving four-bar in the browser, and leave its scene to play with", add_demo, demo_command,
     "Writes four_bar.json, .csv, .png, .svg and .html; a four_bar.json that is there already is shown as it is.\n\n"
     "Example:\n  lockstep demo"},
    {"sweep", "Run a scene many times with other values, one row per run", add_sweep, sweep_command, kSweepFooter},
    {"check", "Read and build a scene; report its bodies, unknowns, rows and degrees of freedom", add_check,
     check_command, "Example:\n  lockstep check samples/scenes/four_bar.json --json"},
    {"chart", "Draw error against CPU time and evaluations for all integrators, formulations, stabilisations, solvers",
     add_chart, chart_command, kChartFooter},
    {"advise", "Measure which method and setting meets an error at the least cost; print how to use it", add_advise,
     advise_command,
     "Measured like `lockstep chart`, only as far as the answer needs. Ends with 1 if nothing met the error.\n\n"
     "Example:\n  lockstep advise samples/scenes/double_pendulum.json --error 1e-6 --until 2"},
    {"assemble", "Bring the start of a scene onto its constraints; report what moved how far", add_assemble,
     assemble_command, "Example:\n  lockstep assemble samples/scenes/four_bar.json"},
    {"statics", "Find where a scene rests under its loads; report poses, reactions and whether it stays there",
     add_statics, statics_command,
     "Newton's method goes downhill, from far away too; where it fails, dynamic relaxation goes on. Velocities are "
     "zero, drives hold their coordinates.\n\n"
     "Example:\n  lockstep statics samples/scenes/double_pendulum.json"},
    {"kinematics", "Follow a fully driven scene over time: positions, velocities, accelerations, without integration",
     add_driven, kinematics_command,
     "Masses are not needed. A scene with too few or too many drives is refused, with the coordinates to drive or the "
     "drives to release.\n\nExample:\n  lockstep kinematics samples/scenes/four_bar.json --until 0.2"},
    {"inverse",
     "Find the forces of the drives and all reactions of a fully driven scene over time, without integration",
     add_driven, inverse_command,
     "Columns: those of the scene, then every drive and every reaction.\n\n"
     "Example:\n  lockstep inverse samples/scenes/four_bar.json --until 0.2"},
    {"explain", "Tell what acts on a body, what a link does and why it is redundant, what laws give, at one instant",
     add_explain, explain_command, "Example:\n  lockstep explain samples/scenes/four_bar.json coupler --at 0.1"},
    {"import", "Read a robot in URDF and write it as a scene", add_import, import_command,
     "Limits become stops, damping becomes forces; what has no place in a scene (meshes, mimicry, friction) is "
     "named.\n\n"
     "Example:\n  lockstep import robot.urdf --out robot.json"},
    {"modes", "Frequencies, damping ratios and shapes about an equilibrium or a steady rotation", add_modes,
     modes_command, kModesFooter},
    {"linearize", "A, B, C, D of the linear equations about a state, with named inputs and outputs", add_linearize,
     linearize_command, kLinearizeFooter},
    {"matrices", "Mass, damping, stiffness, jacobian and right sides at an instant, with the names of rows and columns",
     add_matrices, matrices_command,
     "M a + J^T lambda = f, J a = c.\n\nExample:\n  lockstep matrices samples/scenes/four_bar.json --at 0.1 --out "
     "four_bar"},
    {"atlas", "Draw where each method works and where it fails, over any two numbers of a scene", add_atlas,
     atlas_command, kAtlasFooter},
    {"list", "List the laws, links, forces, integrators and solvers that scenes may name", add_list, list_command,
     "Example:\n  lockstep list links"},
    {"describe", "Print what a type or an object of a scene is and which keys it takes", add_describe, describe_command,
     "Example:\n  lockstep describe revolute"},
    {"schema", "Print the JSON Schema of scene files, for editors", add_plugins, schema_command,
     "Example:\n  lockstep schema > scene.schema.json"},
    {"reference", "Print the reference of scenes as a page in Markdown: every object, type, key and unit", add_plugins,
     reference_command, "Example:\n  lockstep reference > reference.md"},
    {"new-plugin", "Write the folder of a plugin: source, CMake file, test, scene; it builds and passes at once",
     add_new_plugin, new_plugin_command, "Example:\n  lockstep new-plugin link wavy_rail"},
    {"completion", "Print the script by which a shell completes lines: verbs, options, names of the scene",
     add_completion, completion_command,
     "Example:\n  lockstep completion bash > ~/.local/share/bash-completion/completions/lockstep"},
    {"man", "Print the manual page", add_nothing, man_command, "Example:\n  lockstep man | man -l -"},
};
constexpr Verb kPluginsList = {"list", "Load each plugin of the search path; report what it brings", add_plugins_list,
                               plugins_list_command,
                               "Example:\n  LOCKSTEP_PLUGIN_PATH=~/my/plugins lockstep plugins list --why"};

// A word of the command line without the folders of a file that it names.
std::string without_folders(std::string word, const Arguments& args) {
  std::vector<std::string> files{args.scene, args.record, args.report, args.out, args.histories, args.csv};
  files.insert(files.end(), args.plugins.begin(), args.plugins.end());
  for (const std::string& file : files)
    if (const std::size_t slash = file.find_last_of('/'); slash != std::string::npos && word.ends_with(file))
      return word.erase(word.size() - file.size(), slash + 1);
  return word;
}

// "lockstep run four_bar.json --until 3": the same on every machine.
std::string command_words(int argc, const char* const* argv, const Arguments& args) {
  std::string line = "lockstep";
  for (int k = 1; k < argc; ++k) {
    const std::string word = without_folders(argv[k], args);
    const bool plain = !word.empty() && word.find_first_of(" '\"$*?&|;<>()") == std::string::npos;
    line += plain ? " " + word : " '" + word + "'";
  }
  return line;
}

// Prints what is wrong with the command line, the closest name that exists, and where help is.
int print_usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> called = app.get_subcommands();
  const CLI::App& verb = called.empty() ? app : *called.front();
  const std::vector<std::string> unknown = app.remaining(true);
  const std::string word = unknown.empty() ? "" : unknown.front();
  std::vector<std::string> verbs, options;
  for (const CLI::App* v : app.get_subcommands([](const CLI::App*) { return true; })) verbs.push_back(v->get_name());
  for (const CLI::Option* option : verb.get_options())
    for (const std::string& name : option->get_lnames()) options.push_back("--" + name);

  std::string text = error.what();
  if (word.rfind('-', 0) == 0)
    text = "unknown option \"" + word + "\"" + text::suggestion(word.substr(0, word.find('=')), options);
  else if (called.empty())
    text = word.empty() ? "a verb is missing; known: " + text::join(verbs, ", ")
                        : "unknown verb \"" + word + "\"" + text::suggestion(word, verbs);
  else if (!word.empty())
    text = "\"" + word + "\" is one word too many; text with blanks needs quotes";
  const std::string of = called.empty() ? "" : verb.get_name() + " ";
  fmt::print(stderr, "lockstep: {}\nSee `lockstep {}--help`.\n", text, of);
  return kExitUsage;
}

// Without a further request for memory.
int out_of_memory() {
  std::fputs("lockstep: out of memory; record less (output, record), or run fewer copies at once\n", stderr);
  return kExitMemory;
}

int guarded(const std::function<int()>& command) {
  try {
    return command();
  } catch (const Error& error) {
    fmt::print(stderr, "{} {}\n", error_mark(), error.what());
    return exit_code_of(error);
  } catch (const std::bad_alloc&) {
    return out_of_memory();
  } catch (...) {
    fmt::print(stderr, "lockstep: {}\n", thrown_words(std::current_exception()));
    return kExitFailure;
  }
}

int run_words(int argc, const char* const* argv) {
  CLI::App app("lockstep: simulates mechanisms of rigid bodies with the lock formulation", "lockstep");
  app.set_version_flag("--version", std::string("lockstep ") + kVersion);
  app.require_subcommand(1);
  app.footer(
      "Example:\n  lockstep run samples/scenes/four_bar.json\nEach verb has a --help of its own.\n\n"
      "Exit codes: 0 done; 2 command line, 3 scene, 4 plugin or its code, 5 start off the constraints, 6 a step that "
      "cannot be made, 7 a number that is not finite, 8 file; 9 the run went through, but its energy balance or its "
      "drift is beyond the limits (energy_limit, violation_limit); 10 out of memory; 130 interrupted; 1 any other "
      "failure");
  Arguments arguments;
  std::vector<std::pair<const CLI::App*, const Verb*>> verbs;
  const auto add_verb = [&](CLI::App& parent, const Verb& verb) {
    CLI::App* sub = parent.add_subcommand(verb.name, verb.help);
    verb.add_options(*sub, arguments);
    sub->footer(verb.footer);
    verbs.emplace_back(sub, &verb);
  };
  for (const Verb& verb : kVerbs) add_verb(app, verb);
  CLI::App& plugins = *app.add_subcommand("plugins", "Report which plugins there are");
  plugins.require_subcommand(1);
  add_verb(plugins, kPluginsList);

  arguments.line = &app;
  if (argc > 1 && std::string_view(argv[1]) == "complete") return complete_command(app, argc - 2, argv + 2);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return error.get_exit_code() == 0 ? app.exit(error) : print_usage_error(app, error);
  }
  const auto called = std::find_if(verbs.begin(), verbs.end(), [](const auto& v) { return v.first->parsed(); });
  arguments.command = command_words(argc, argv, arguments);
  const int code = guarded([&] { return called->second->run(arguments); });
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  std::fputs("lockstep: standard output cannot be written; what was printed is not complete\n", stderr);
  return code == kExitOk || code == kExitFailure ? kExitFile : code;  // a failed write may have ended the command
}

}  // namespace

int exit_code_of(const Error& error) {
  using Kind = Error::Kind;
  static const std::map<Kind, Exit> kCodes{{Kind::usage, kExitUsage},
                                           {Kind::scene, kExitScene},
                                           {Kind::model, kExitScene},
                                           {Kind::plugin, kExitPlugin},
                                           {Kind::user_code, kExitPlugin},
                                           {Kind::assembly, kExitAssembly},
                                           {Kind::step, kExitStep},
                                           {Kind::solve, kExitStep},
                                           {Kind::non_finite, kExitNonFinite},
                                           {Kind::file, kExitFile},
                                           {Kind::interrupted, kExitInterrupted}};
  const auto code = kCodes.find(error.kind());
  return code == kCodes.end() ? kExitFailure : code->second;
}

int run_program(int argc, const char* const* argv) {
  try {
    return run_words(argc, argv);
  } catch (const std::bad_alloc&) {
    return out_of_memory();
  }
}

}  // namespace lockstep
