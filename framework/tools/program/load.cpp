// From the words of the command line to a scene and a registry.
#include <cctype>
#include <charconv>
#include <filesystem>
#include <set>

#include <lockstep/registry.h>
#include "framework/mechanism/params/units.h"
#include <lockstep/loader.h>
#include "framework/tools/program/ways.h"
#include <lockstep/text.h>

namespace lockstep {
namespace {

// A number of the command line, in SI or with a unit; greater than zero.
double positive_number(const std::string& option, const std::string& text, Unit unit) {
  double x = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc() || end != text.data() + text.size()) {
    const Measured measured = read_quantity(text, unit);
    if (!measured.problem.empty() || unit == Unit::none)
      throw UsageError(option + ": \"" + text + "\" is no " + name_of(unit) + "; write it as in " + option + " " +
                       (unit == Unit::none ? "1e-6" : "0.001"));
    x = measured.value;
  }
  if (!(x > 0) || x > 1e300)
    throw UsageError(option + ": the value is " + text + "; it must be greater than 0 and finite");
  return x;
}

// The picture stands beside the table under the table's name: it would take its place.
void refuse_picture(const std::string& record) {
  const std::filesystem::path file = record;
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (ending != ".png" && ending != ".svg") return;
  throw UsageError("--record: \"" + record + "\" is where the picture goes, not the table; name a CSV file, as in " +
                   "--record " + std::filesystem::path(file).replace_extension(".csv").string());
}

bool takes_fixed_steps(const RunSettings& run, const Registry& registry) {
  RunSettings with_step = run;
  with_step.step = 1;
  return !make_integrator(with_step, registry)->info().adaptive;
}

void refuse_missing_step(const RunSettings& run, const Words& w, const Registry& registry) {
  if (w.integrator.empty() || run.step > 0) return;
  if (takes_fixed_steps(run, registry))
    throw UsageError("--integrator: \"" + w.integrator +
                     "\" takes fixed steps and no step is given; add --step, as in --step 0.001");
}

// A step that the scene gives to a method of fixed steps is no limit for an adaptive one that the command line names.
void put_integrator(RunSettings& run, const Words& w, const Registry& registry) {
  if (w.integrator.empty()) return;
  const bool was_fixed =
      run.step > 0 && registry.integrators.find(run.integrator.type) != nullptr && takes_fixed_steps(run, registry);
  run.integrator = read_way("--integrator", w.integrator, types_of(registry.integrators));
  if (was_fixed && !takes_fixed_steps(run, registry)) run.step = 0;
}

void put_settings(RunSettings& run, const Words& w, const Registry& registry) {
  put_integrator(run, w, registry);
  if (!w.solver.empty()) run.solver = read_way("--solver", w.solver, types_of(registry.solvers));
  if (!w.step.empty()) run.step = positive_number("--step", w.step, Unit::time);
  if (!w.until.empty()) run.until = positive_number("--until", w.until, Unit::time);
  if (!w.tolerance.empty()) {
    run.tolerance.relative = positive_number("--tolerance", w.tolerance, Unit::none);
    run.tolerance.atol_x = 1e-2 * run.tolerance.relative;
  }
  if (!w.formulation.empty())
    run.formulation = w.formulation == "quaternion" ? Formulation::quaternion : Formulation::omega;
  if (w.formulation == "quaternion" && w.solver.empty() && run.solver.type == "schur")
    run.solver.type = "sparse";  // the default reads six velocities
  if (w.stabilization == "project") run.stabilization.kind = Stabilization::Kind::project;
  if (w.stabilization == "baumgarte") run.stabilization.kind = Stabilization::Kind::baumgarte;
  if (w.stabilization == "none") run.stabilization.kind = Stabilization::Kind::none;
}

// Planar motion and merged bodies, as the command line wants them.
void put_economies(Scene& scene, const Words& w) {
  if (w.full) scene.root = scene.root.without({"planar", "merge"});
  if (w.planar.empty()) return;
  scene.root = scene.root.without({"planar"});
  scene.root.object()->push_back({"planar", Value(w.planar), scene.root.where});
}

}  // namespace

Registry make_registry(const std::vector<std::string>& plugins, const std::vector<std::string>& required) {
  Registry registry = builtin_registry();
  std::set<std::string> files, names;
  const auto load_once = [&](const std::string& plugin) {  // one file may be named by its name and by its path
    if (files.insert(find_plugin(plugin, {})).second) load_plugin(registry, plugin);
    names.insert(plugin_name(plugin));
  };
  for (const std::string& plugin : plugins) load_once(plugin);
  for (const std::string& plugin : required)
    if (names.count(plugin_name(plugin)) == 0) load_once(plugin);
  return registry;
}

Loaded read_with_plugins(const Words& w) {
  refuse_picture(w.record);
  Scene scene = read_scene(w.scene);
  Registry registry = make_registry(w.plugins, scene.plugins);
  put_economies(scene, w);
  return {std::move(registry), std::move(scene)};
}

void put_over(RunSettings& run, const Words& w, const Registry& registry) {
  put_settings(run, w, registry);
  refuse_missing_step(run, w, registry);
}

Loaded load(const Words& w) {
  Loaded loaded = read_with_plugins(w);
  put_over(loaded.scene.run, w, loaded.registry);
  return loaded;
}

}  // namespace lockstep
