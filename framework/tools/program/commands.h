// The verbs of the program `lockstep`: one function each over the public interface.
#pragma once

#include <string>
#include <vector>

#include <lockstep/registry.h>
#include <lockstep/scene.h>

namespace lockstep {

/// What the program ends with.
enum Exit {
  kExitOk = 0,
  kExitFailure = 1,  ///< something that has no number of its own
  kExitUsage = 2,
  kExitScene = 3,
  kExitPlugin = 4,
  kExitAssembly = 5,
  kExitStep = 6,
  kExitNonFinite = 7,
  kExitFile = 8,
  kExitInterrupted = 130
};

/// Words on the command line that cannot be.
class UsageError : public Error {
 public:
  using Error::Error;
  Kind kind() const noexcept override { return Kind::usage; }
};

/// What the command line says about a scene and how to run it. Empty: not said.
struct Words {
  std::string scene, integrator, solver, step, tolerance, until, formulation, stabilization, record, budget, out, error,
      of = "position", tolerances, steps;
  std::string planar;  ///< as the scene's key
  std::vector<std::string> plugins, integrators, solvers, formulations, stabilizations;
  bool quiet = false, json = false, why = false, channels = false, separately = false, certify = false;
  bool full = false;              ///< every economy off
  std::vector<std::string> vary;  ///< NAME=a:b:n or NAME=v1,v2,...
  std::string shard, histories;   ///< "2/8"; a folder
  std::string lanes;              ///< "off": one run at a time
  std::string kind, name, into;   ///< of a new plugin
};

/// A scene with the plugins that it and the command line ask for.
struct Loaded {
  Registry registry;
  Scene scene;
};

/// Built-in things and those of the plugins: of the command line, by name or path; then those that a scene requires, by
/// name, but for names that the command line gave a file already.
Registry make_registry(const std::vector<std::string>& plugins, const std::vector<std::string>& required = {});
/// Reads the scene and loads plugins; the run settings are the scene's own.
Loaded read_with_plugins(const Words&);
/// What the command line says of the run, over what the scene says. Throws UsageError.
void put_over(RunSettings&, const Words&, const Registry&);
/// Both: reads the scene, loads plugins, puts what the command line says over the scene's run settings. Throws
/// UsageError too.
Loaded load(const Words&);

int run_command(const Words&);
int check_command(const Words&);
int chart_command(const Words&);
int advise_command(const Words&);
int sweep_command(const Words&);
int assemble_command(const Words&);
int list_command(const std::string& shelf, const Words&);
int describe_command(const std::string& name, const Words&);
int schema_command(const Words&);
int new_plugin_command(const Words&);
int plugins_list_command(const Words&);

/// Reads the command line, calls a verb, says errors on standard error. Returns an Exit.
int run_program(int argc, const char* const* argv);

}  // namespace lockstep
