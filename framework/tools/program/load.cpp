// SPDX-License-Identifier: BSD-3-Clause
// From the command line to a scene and a registry.
#include <boost/algorithm/string/predicate.hpp>
#include <filesystem>
#include <set>

#include <lockstep/author/loader.h>
#include <lockstep/author/registry.h>
#include <lockstep/text.h>
#include "framework/description/scene/json.h"
#include "framework/description/scene/reading.h"
#include "framework/description/scene/tree.h"
#include "framework/mechanism/params/read.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/method_specs.h"

namespace lockstep {
namespace {

// The picture has the name of the table with another ending: a table of that name would be overwritten.
void refuse_picture(const std::string& record) {
  if (!boost::iends_with(record, ".png") && !boost::iends_with(record, ".svg")) return;
  throw UsageError("--record: \"" + record + "\" is the name of the picture; name a CSV file, as in --record " +
                   std::filesystem::path(record).replace_extension(".csv").string());
}

void refuse_missing_step(const RunSettings& run, const Arguments& args, const Registry& registry) {
  if (args["--integrator"].empty() || run.step > 0) return;
  if (!integrator_info(run, registry).adaptive)
    throw UsageError("--integrator: \"" + args["--integrator"] +
                     "\" has fixed steps and no step is given; add --step, as in --step 0.001");
}

// The step of the scene's fixed-step method does not limit an adaptive one that the command line names.
void put_integrator(RunSettings& run, const Arguments& args, const Registry& registry) {
  if (args["--integrator"].empty()) return;
  const bool was_fixed = run.step > 0 && registry.integrators.find(run.integrator.type) != nullptr &&
                         !integrator_info(run, registry).adaptive;
  run.integrator = read_spec("--integrator", args["--integrator"], types_of(registry.integrators));
  if (was_fixed && integrator_info(run, registry).adaptive) run.step = 0;
}

// A table beyond any memory.
void refuse_rows(const RunSettings& run, const Arguments& args) {
  constexpr double kMost = 1e8;
  if (!(run.output > 0 && run.until / run.output > kMost)) return;
  const std::string problem = text::brief(run.output) + " s over " + text::brief(run.until) + " s gives " +
                              text::brief(run.until / run.output) + " rows (limit " + text::brief(kMost) +
                              "); use a longer interval";
  if (!args["--output"].empty()) throw UsageError("--output: " + problem);
  refuse(run.where, "run.output", problem);
}

// Planar motion and merged bodies.
void put_shortcuts(Scene& scene, const Arguments& args) {
  if (args.has("--full")) {
    change_root(scene, [](Value& root) {
      root = root.without({"merge"});
      put(root, "planar", Value("off"));
    });
  }
  if (!args["--planar"].empty()) change_root(scene, [&](Value& root) { put(root, "planar", Value(args["--planar"])); });
}

}  // namespace

Registry make_registry(const std::vector<std::string>& plugins, const std::vector<std::string>& required) {
  Registry registry = builtin_registry();
  std::set<std::string> files, names;
  const auto load_once = [&](const std::string& plugin) {  // a plugin may be given by its name and by its path
    if (files.insert(find_plugin(plugin, {})).second) load_plugin(registry, plugin);
    names.insert(plugin_name(plugin));
  };
  for (const std::string& plugin : plugins) load_once(plugin);
  for (const std::string& plugin : required)
    if (names.count(plugin_name(plugin)) == 0) load_once(plugin);
  return registry;
}

Loaded read_with_plugins(const Arguments& args) {
  refuse_picture(args["--record"]);
  const bool piped = args["scene"] == "-";
  const std::string file = piped ? "standard input" : scene_or_sample(args["scene"]);
  IncludeRule rule;
  if (!args.has("--allow-files"))
    rule = [&](const Value& named, const std::string& path) { check_file(file, named, path, *named.text()); };
  Scene scene = scene_from(piped ? read_json(standard_input(), file) : read_json_file(file), file, rule);
  if (!args.has("--allow-files")) check_files(scene);
  Registry registry = make_registry(args.all("--plugin"), scene.plugins);
  const std::vector<std::string>& values =
      args.all("--set");  // all together: one alone may not fit the others' old ones
  if (!values.empty()) scene = as_usage("--set", [&] { return set_in_scene(scene, values, registry); });
  put_shortcuts(scene, args);
  return {std::move(registry), std::move(scene)};
}

void override_settings(RunSettings& run, const Arguments& args, const Registry& registry) {
  put_integrator(run, args, registry);
  if (!args["--solver"].empty()) run.solver = read_spec("--solver", args["--solver"], types_of(registry.solvers));
  if (!args["--step"].empty()) run.step = positive_number("--step", args["--step"], Unit::time);
  if (!args["--until"].empty()) run.until = instant("--until", args["--until"]);
  if (!args["--output"].empty())
    run.output = positive_number("--output", args["--output"], Unit::time), run.times.clear();
  if (!args["--tolerance"].empty()) {
    const double relative = positive_number("--tolerance", args["--tolerance"], Unit::none);
    run.tolerance = as_usage("--tolerance", [&] { return tolerance_of(relative); });
  }
  if (!args["--formulation"].empty())
    run.formulation = formulation_from(args["--formulation"]);
  else if ((args.has("--full") || !args["--solver"].empty()) && run.formulation == Formulation::automatic)
    run.formulation = Formulation::omega;
  if (run.formulation == Formulation::joint && !args["--solver"].empty())
    throw UsageError("--solver: joint coordinates need no linear solver; leave out \"" + args["--solver"] +
                     "\", or give --formulation omega");
  if (args["--formulation"] == "quaternion" && args["--solver"].empty() && run.solver.type == "schur")
    run.solver.type = "sparse";  // the default needs six velocities per body
  run.at_jumps = run.at_jumps || args.has("--at-jumps");
  if (!args["--nearly-redundant"].empty()) run.nearly_redundant = nearly_redundant_from(args["--nearly-redundant"]);
  if (!args["--stabilization"].empty()) run.stabilization.kind = stabilization_from(args["--stabilization"]);
  refuse_missing_step(run, args, registry);
  refuse_rows(run, args);
}

Loaded load(const Arguments& args) {
  Loaded loaded = read_with_plugins(args);
  override_settings(loaded.scene.run, args, loaded.registry);
  return loaded;
}

}  // namespace lockstep
