// The verbs of the program `lockstep`: one function each over the public interface; and what all programs share.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/scene.h>

namespace CLI {
class App;
}

namespace lockstep {

/// The exit codes of the program.
enum Exit {
  kExitOk = 0,
  kExitFailure = 1,  ///< anything without a code of its own
  kExitUsage = 2,
  kExitScene = 3,
  kExitPlugin = 4,
  kExitAssembly = 5,
  kExitStep = 6,
  kExitNonFinite = 7,
  kExitFile = 8,
  kExitNotConserved = 9,  ///< the run went through, and its energy balance or its violation is beyond the limits
  kExitMemory = 10,
  /// It went through, and its result is doubtful: with --strict by doubts_of (run_words.h), with --certify by a column of
  /// which not one digit is certified.
  kExitDoubtful = 11,
  kExitInterrupted = 130
};

/// An invalid command line.
class UsageError : public Error {
 public:
  using Error::Error;
  Kind kind() const noexcept override { return Kind::usage; }
};

/// The options of the command line, as text; "" if not given.
struct Arguments {
  std::string scene, integrator, solver, step, tolerance, until, formulation, stabilization, record, budget, out, error,
      of = "position", tolerances, steps;
  std::string planar;  ///< as the scene's key
  std::vector<std::string> plugins, integrators, solvers, formulations, stabilizations;
  bool quiet = false, json = false, why = false, channels = false, separately = false, certify = false;
  bool floating = false;          ///< the first link of an imported robot is not held
  bool no_picture = false;        ///< CSV alone
  std::optional<std::string> caption;  ///< below pictures of what was measured; none: machine, version and date
  bool strict = false;            ///< a doubtful result is an error
  std::vector<std::string> pictures;  ///< X:Y, columns
  std::string headers;                ///< "units" or "plain"; "": the scene's
  bool at_jumps = false;              ///< rows before and after what jumps
  bool allow_files = false;       ///< the scene may read files outside of its folder
  std::string nearly_redundant;   ///< auto, told, free or held
  bool full = false;              ///< no shortcuts: neither planar motion nor merged bodies
  std::vector<std::string> vary;  ///< NAME=a:b:n or NAME=v1,v2,...
  std::vector<std::string> set;   ///< NAME=VALUE
  std::string shard, histories;   ///< "2/8"; a folder
  std::string report;             ///< the HTML file
  bool open = false, no_open = false;  ///< show it in the browser; do not
  std::string command;            ///< the whole command line, files by their names alone
  std::string lanes;              ///< "off": one run at a time
  int jobs = 0;                   ///< threads of a sweep; 0: as many as there are processors
  std::vector<std::string> more_scenes;  ///< after the first
  const CLI::App* line = nullptr;        ///< the command line itself, for its manual
  std::string kind, name, into;   ///< kind and folder of a new plugin, or of the demo; its name, a shelf's or a type's
  std::string within;             ///< a distance
  std::string branches;           ///< random starts of assemble; "": branches are not looked for
  std::string all;                ///< random starts of statics; "": one equilibrium
  bool nearest = false;           ///< statics takes the equilibrium that it meets first
  std::string at, interval;       ///< an instant; the interval of outputs
  std::string count, spin, csv;   ///< how many modes; a vector; a file
  bool frozen = false;            ///< coefficients of an instant that is no equilibrium
  std::vector<std::string> inputs, outputs;  ///< of a linearisation
  std::string checkpoint, every;             ///< the file of a checkpoint; how often it is written, by the clock
  bool resume = false;                       ///< a sweep goes on where it was interrupted
  std::vector<std::string> words;            ///< of the command line, after the program's name
};

/// A scene with the plugins that it and the command line ask for.
struct Loaded {
  Registry registry;
  Scene scene;

  /// The scene's title, or its file if it has none.
  const std::string& title() const { return scene.title.empty() ? scene.file : scene.title; }
};

/// Built-in types and those of plugins: first of those that the command line gives by name or path, then of those that
/// a scene requires by name, unless the command line gave a file of that name.
Registry make_registry(const std::vector<std::string>& plugins, const std::vector<std::string>& required = {});
/// Reads the scene and loads plugins; the run settings are the scene's own.
Loaded read_with_plugins(const Arguments&);
/// Replaces run settings of the scene by those of the command line. Throws UsageError.
void override_settings(RunSettings&, const Arguments&, const Registry&);
/// Reads the scene, loads plugins and overrides the run settings.
Loaded load(const Arguments&);

/// The command line of an earlier run, `lockstep run` ..., by its words after the program's name.
Arguments read_run_words(const std::vector<std::string>& words);

/// The commit that the program was built from, if the tree was clean; else "".
std::string_view commit_of_build();

/// The code for an error.
int exit_code_of(const Error&);

int run_command(const Arguments&);
int resume_command(const Arguments&);
int report_command(const Arguments&);
int demo_command(const Arguments&);
int check_command(const Arguments&);
int reference_command(const Arguments&);
int list_command(const Arguments&);
int describe_command(const Arguments&);
int schema_command(const Arguments&);
int new_plugin_command(const Arguments&);
int plugins_list_command(const Arguments&);
/// A verb that no help shows: answers `plugins list` about one file, whose code may end this process.
int plugin_answer_command(const char* file);

struct Verb;

/// The verbs of a program, and whether it is the one that finds the others (tools.h).
struct Program {
  std::span<const Verb> verbs;
  bool calls_tools = false;
};

/// Reads the command line, runs a verb, prints errors on standard error. Returns an Exit.
int run_program(const Program&, int argc, const char* const* argv);

}  // namespace lockstep
