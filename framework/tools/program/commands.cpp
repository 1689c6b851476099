// The command line: which verbs and options there are, and which number an error ends with.
#include "framework/tools/program/commands.h"

#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <functional>

#include "framework/description/scene/describe.h"
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/support/thrown.h"
#include <lockstep/version.h>

namespace lockstep {
namespace {

void add_plugins(CLI::App& verb, Words& w) {
  verb.add_option("--plugin", w.plugins, "load a plugin, by name or path; may be given several times")
      ->type_name("P")
      ->allow_extra_args(false);
}

void add_scene(CLI::App& verb, Words& w) {
  verb.add_option("scene", w.scene, "the scene file (JSON)")->required()->type_name("SCENE");
  add_plugins(verb, w);
  verb.add_option("--planar", w.planar, "motion in a plane, by its normal; auto: where that is exact")
      ->check(CLI::IsMember({"off", "auto", "x", "y", "z"}))
      ->type_name("AXIS");
  verb.add_flag("--full", w.full, "leave nothing out: neither planar motion nor merged bodies");
}

// What run and sweep share.
void add_settings(CLI::App& verb, Words& w) {
  add_scene(verb, w);
  verb.add_option("--integrator", w.integrator, "see `lockstep list integrators`; with keys: dopri5:fixed=true")
      ->type_name("N");
  CLI::Option* step =
      verb.add_option("--step", w.step, "fixed step, or the largest step of an adaptive integrator, s")->type_name("H");
  verb.add_option("--tolerance", w.tolerance, "relative tolerance of adaptive integrators")
      ->type_name("T")
      ->excludes(step);
  verb.add_option("--until", w.until, "end of the run, s")->type_name("T");
  verb.add_option("--formulation", w.formulation, "6 velocities a body, or the paper's 7 coordinates")
      ->check(CLI::IsMember({"omega", "quaternion"}))
      ->type_name("F");
  verb.add_option("--stabilization", w.stabilization, "how drift off the constraints is fought")
      ->check(CLI::IsMember({"project", "baumgarte", "none"}))
      ->type_name("S");
  verb.add_option("--solver", w.solver, "see `lockstep list solvers`")->type_name("N");
}

CLI::App& add_run(CLI::App& app, Words& w) {
  CLI::App& verb = *app.add_subcommand("run", "Compute the motion of a scene, write CSV and a picture");
  add_settings(verb, w);
  CLI::Option* certify = verb.add_flag(
      "--certify", w.certify,
      "run it again with a tighter tolerance and with a second method; say how many digits of each column agree");
  verb.add_option("--budget", w.budget, "computing time that the runs of --certify may take together; default 60 s")
      ->type_name("T")
      ->needs(certify);
  verb.add_option("--record", w.record, "where the columns go; default: <scene>.csv in LOCKSTEP_OUTPUT or here")
      ->type_name("FILE.csv");
  verb.add_flag("--quiet", w.quiet, "say nothing but errors");
  verb.footer("Example:\n  lockstep run samples/scenes/four_bar.json --integrator rk4 --step 1e-3 --record out.csv");
  return verb;
}

constexpr const char* kSweepFooter =
    R"(NAME is a path into the scene: bodies.arm.mass, links.A.drive.law.slope, gravity.1, run.tolerance; things of a
list go by their name or by their number from 0 on. Units are those of scenes: bodies.arm.mass=200g:1kg:5. Several --vary
make the full grid. Each run is one row: its number, the values, final, min and max of each recorded column, steps,
CPU seconds, status. A run that fails is a row with its reason; then the exit code is 1. Ctrl-C keeps the rows so far.

Example:
  lockstep sweep pendulum.json --vary bodies.rod.rod.mass=1:5:100 --vary gravity.1=-9.81,-1.62 --record moon.csv
With GNU parallel, eight shares on all cores of this machine (units without blanks):
  parallel lockstep sweep pendulum.json --vary bodies.rod.rod.mass=1:5:100 --quiet --shard {}/8 --record mass_{}.csv ::: $(seq 8)
Under Slurm, sbatch of a script with these lines:
  #SBATCH --array=1-8
  i=$SLURM_ARRAY_TASK_ID n=$SLURM_ARRAY_TASK_COUNT
  lockstep sweep pendulum.json --vary bodies.rod.rod.mass=1:5:100 --quiet --shard $i/$n --record mass_$i.csv
The shares have one header and become one table, in the order of the whole grid, by
  awk 'FNR > 1 || NR == 1' mass_*.csv | sort -t , -k 1,1n > mass.csv)";

CLI::App& add_sweep(CLI::App& app, Words& w) {
  CLI::App& verb = *app.add_subcommand("sweep", "Run a scene many times with other values, one row a run");
  add_settings(verb, w);
  verb.add_option("--vary", w.vary, "NAME=a:b:n, n values evenly from a to b, or NAME=v1,v2,...; may be given again")
      ->required()
      ->type_name("NAME=...")
      ->allow_extra_args(false);
  verb.add_option("--shard", w.shard, "only every n-th run from the i-th on; i counts from 1")->type_name("i/n");
  verb.add_option("--record", w.record,
                  "where the rows go; default: <scene>_sweep.csv or <scene>_sweep_<i>of<n>.csv, in LOCKSTEP_OUTPUT or "
                  "here")
      ->type_name("FILE.csv");
  verb.add_option("--lanes", w.lanes, "auto: eight runs at once where the mechanism is suited; off: one by one")
      ->check(CLI::IsMember({"auto", "off"}))
      ->type_name("MODE");
  verb.add_option("--histories", w.histories, "folder for the columns of each run, <its number>.csv")->type_name("DIR");
  verb.add_flag("--quiet", w.quiet, "say nothing but errors");
  verb.footer(kSweepFooter);
  return verb;
}

// Which combinations are measured, and how long.
void add_survey(CLI::App& verb, Words& w) {
  add_scene(verb, w);
  const auto list = [&](const char* names, std::vector<std::string>& to, const char* help) {
    return verb.add_option(names, to, help)->delimiter(',')->allow_extra_args(false)->type_name("A,B");
  };
  list("--integrators", w.integrators, "only these, with keys where wanted: rk4,dopri5:fixed=true; default: all");
  list("--formulations", w.formulations, "only these: omega, quaternion; default: both")
      ->check(CLI::IsMember({"omega", "quaternion"}));
  list("--stabilizations,--stabilisations", w.stabilizations, "only these: project, baumgarte, none; default: all")
      ->check(CLI::IsMember({"project", "baumgarte", "none"}));
  list("--solvers", w.solvers, "only these; default: all of `lockstep list solvers`");
  verb.add_flag("--separately", w.separately,
                "vary one of the four at a time, the others as the scene has them: faster than every combination");
  verb.add_option("--tolerances", w.tolerances, "range for adaptive integrators; default 1:1e-12")
      ->type_name("COARSE:FINE");
  verb.add_option("--steps", w.steps, "range for fixed steps, s; default: a hundredth of the run and 2^14 times less")
      ->type_name("COARSE:FINE");
  verb.add_option("--until", w.until, "end of the runs, s")->type_name("T");
  verb.add_option("--budget", w.budget, "computing time that all runs together may take; default 60 s")->type_name("T");
  verb.add_flag("--quiet", w.quiet, "do not print each run");
}

CLI::App& add_chart(CLI::App& app, Words& w) {
  CLI::App& verb = *app.add_subcommand(
      "chart",
      "Draw error against CPU time and evaluations for all integrators, formulations, stabilisations, solvers");
  add_survey(verb, w);
  verb.add_option("--out", w.out, "folder for CSV and pictures; default: LOCKSTEP_OUTPUT or here")->type_name("DIR");
  verb.footer(
      "Each combination climbs from coarse to fine settings, cheapest next run first, until its error stops falling, "
      "it\n"
      "costs a hundred times what another takes for the same error, or the time is spent. Errors are the largest over "
      "the\n"
      "history at 101 instants, against the tightest run of one method; a second method says how good that truth is.\n"
      "A run counts only if all finer runs of its combination stay within twice its error. \"<=\": no coarser run "
      "missed.\n\n"
      "Example:\n  lockstep chart samples/scenes/four_bar.json --budget 60s --out charts\n"
      "  lockstep chart samples/scenes/chain_10.json --integrators dopri5,dop853 --formulations omega");
  return verb;
}

CLI::App& add_advise(CLI::App& app, Words& w) {
  CLI::App& verb = *app.add_subcommand(
      "advise", "Measure which method and setting meets an error at the least cost; say how to use it");
  add_survey(verb, w);
  verb.add_option("--error", w.error, "wanted error over the whole run, SI units; default 1e-6")->type_name("E");
  verb.add_option("--of", w.of, "what the error is of: position (m), velocity (m/s), energy (J), reaction (N)")
      ->check(CLI::IsMember({"position", "velocity", "energy", "reaction"}))
      ->type_name("WHAT");
  verb.footer(
      "Measured like `lockstep chart`, only as far as the answer needs. Ends with 1 when nothing met the error.\n\n"
      "Example:\n  lockstep advise samples/scenes/double_pendulum.json --error 1e-6 --until 2");
  return verb;
}

CLI::App& add_new_plugin(CLI::App& app, Words& w) {
  CLI::App& verb = *app.add_subcommand(
      "new-plugin", "Write the folder of a plugin: source, CMake file, test, scene; it builds and passes at once");
  verb.add_option("kind", w.kind, "link, coupling, law, force or integrator")
      ->required()
      ->check(CLI::IsMember({"link", "coupling", "law", "force", "integrator"}))
      ->type_name("KIND");
  verb.add_option("name", w.name, "what scenes call it, and the folder: small letters, digits and _")
      ->required()
      ->type_name("NAME");
  verb.add_option("--into", w.into, "where its folder goes; default: here")->type_name("DIR");
  verb.footer("Example:\n  lockstep new-plugin link wavy_rail");
  return verb;
}

int exit_code_of(const Error& error) {
  using Kind = Error::Kind;
  switch (error.kind()) {
    case Kind::usage: return kExitUsage;
    case Kind::scene:
    case Kind::model: return kExitScene;
    case Kind::plugin:
    case Kind::user_code: return kExitPlugin;
    case Kind::assembly: return kExitAssembly;
    case Kind::step:
    case Kind::solve: return kExitStep;
    case Kind::non_finite: return kExitNonFinite;
    case Kind::file: return kExitFile;
    case Kind::interrupted: return kExitInterrupted;
    case Kind::other: break;
  }
  return kExitFailure;
}

// What is wrong with the words, the closest that exists, and where help is.
int say_usage(const CLI::App& app, const CLI::ParseError& error) {
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

int guarded(const std::function<int()>& command) {
  try {
    return command();
  } catch (const Error& error) {
    fmt::print(stderr, "lockstep: {}\n", error.what());
    return exit_code_of(error);
  } catch (const std::exception& error) {
    fmt::print(stderr, "lockstep: {}\n", what_of(error));
    return kExitFailure;
  } catch (...) {
    fmt::print(stderr, "lockstep: {}\n", thrown_words(std::current_exception()));
    return kExitFailure;
  }
}

}  // namespace

int run_program(int argc, const char* const* argv) {
  CLI::App app("lockstep: simulates mechanisms of rigid bodies with the lock formulation", "lockstep");
  app.set_version_flag("--version", std::string("lockstep ") + kVersion);
  app.require_subcommand(1);
  app.footer("Example:\n  lockstep run samples/scenes/four_bar.json\nEach verb has a --help of its own.");
  Words w;
  std::string name;

  CLI::App& run = add_run(app, w);
  CLI::App& sweep = add_sweep(app, w);
  CLI::App& check =
      *app.add_subcommand("check", "Read and build a scene; say its bodies, unknowns, rows and degrees of freedom");
  add_scene(check, w);
  check.add_flag("--json", w.json, "as JSON");
  check.add_flag("--channels", w.channels, "list every channel that the scene may record, with unit and meaning");
  check.footer("Example:\n  lockstep check samples/scenes/four_bar.json --json");
  CLI::App& chart = add_chart(app, w);
  CLI::App& advise = add_advise(app, w);
  CLI::App& assemble =
      *app.add_subcommand("assemble", "Bring the start of a scene onto its constraints; say what moved how far");
  add_scene(assemble, w);
  assemble.add_flag("--json", w.json, "as JSON");
  assemble.footer("Example:\n  lockstep assemble samples/scenes/four_bar.json");
  CLI::App& list =
      *app.add_subcommand("list", "List the laws, links, forces, integrators and solvers that scenes may name");
  list.add_option("shelf", name, "only one of them")
      ->check(CLI::IsMember({"links", "laws", "forces", "integrators", "solvers"}))
      ->type_name("SHELF");
  add_plugins(list, w);
  list.add_flag("--json", w.json, "as JSON");
  list.footer("Example:\n  lockstep list links");
  CLI::App& describe =
      *app.add_subcommand("describe", "Say what a type or an object of a scene is and which keys it takes");
  describe.add_option("name", name, "a name of `lockstep list`, or body, marker, link, force, event, run, ...")
      ->required()
      ->type_name("NAME");
  add_plugins(describe, w);
  describe.footer("Example:\n  lockstep describe revolute");
  CLI::App& schema = *app.add_subcommand("schema", "Print the JSON Schema of scene files, for editors");
  add_plugins(schema, w);
  schema.footer("Example:\n  lockstep schema > scene.schema.json");
  CLI::App& new_plugin = add_new_plugin(app, w);
  CLI::App& plugins = *app.add_subcommand("plugins", "Say which plugins there are");
  plugins.require_subcommand(1);
  CLI::App& plugins_list = *plugins.add_subcommand("list", "Load each plugin of the search path; say what it brings");
  plugins_list.add_flag("--why", w.why, "say all: folders, files, builds, and why one is refused");
  plugins_list.add_flag("--json", w.json, "as JSON");
  plugins_list.footer("Example:\n  LOCKSTEP_PLUGIN_PATH=~/my/plugins lockstep plugins list --why");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return error.get_exit_code() == 0 ? app.exit(error) : say_usage(app, error);
  }
  return guarded([&] {
    if (run.parsed()) return run_command(w);
    if (sweep.parsed()) return sweep_command(w);
    if (check.parsed()) return check_command(w);
    if (chart.parsed()) return chart_command(w);
    if (advise.parsed()) return advise_command(w);
    if (assemble.parsed()) return assemble_command(w);
    if (list.parsed()) return list_command(name, w);
    if (describe.parsed()) return describe_command(name, w);
    if (new_plugin.parsed()) return new_plugin_command(w);
    if (plugins_list.parsed()) return plugins_list_command(w);
    return schema.parsed() ? schema_command(w) : int(kExitUsage);
  });
}

}  // namespace lockstep
