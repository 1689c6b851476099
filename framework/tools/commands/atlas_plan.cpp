// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/atlas_plan.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include <lockstep/error.h>
#include "framework/description/scene/reading.h"
#include "framework/tools/commands/benchmark.h"

namespace lockstep {

Scene AtlasPlan::scene(long run, const AtlasPanel& panel) const {
  Scene s = VariedScene::scene(run);
  s.run.integrator = panel.integrator, s.run.stabilization.kind = panel.stabilization;
  return s;
}

std::string AtlasPlan::reference_key(long run) const {
  const std::vector<std::size_t> at = grid.at(run);
  std::string key;
  for (std::size_t k = 0; k < variables.size(); ++k)
    if (!variables[k].place.starts_with("run.") || variables[k].place == "run.until") key += fmt::format("{},", at[k]);
  return key;
}

std::vector<double> axis_numbers(const Variable& v) {
  std::vector<double> all;
  for (const Value& value : v.values) {
    if (value.number() == nullptr)
      throw UsageError("--vary: \"" + v.path +
                       "\": an axis of a map needs numbers; for words use --integrators or --stabilizations");
    all.push_back(*value.number());
  }
  if (all.size() < 2 || !std::ranges::is_sorted(all, std::ranges::less_equal()))
    throw UsageError("--vary: \"" + v.path + "\": an axis of a map needs at least two increasing values");
  return all;
}

AtlasPlan make_atlas_plan(const Arguments& args) {
  AtlasPlan plan{read_varied(args), {}, {}, budget_of(args)};
  if (plan.variables.size() != 2) throw UsageError("--vary: a map has two axes; give --vary twice");
  bool gains = false;
  for (const Variable& v : plan.variables) {
    axis_numbers(v);
    gains = gains || v.place.starts_with("run.stabilization.");
  }
  if (!args["--error"].empty()) {
    plan.limits.works = positive_number("--error", args["--error"], Unit::none);
    plan.limits.wrong = std::max(plan.limits.wrong, plan.limits.works);
  }

  const std::vector<TypeInfo> types = types_of(plan.loaded.registry.integrators);
  std::vector<MethodSpec> methods;
  if (args.all("--integrators").empty())
    for (const TypeInfo& type : types) methods.push_back({type.name, Value(Value::Object{}), {}});
  for (const std::string& name : args.all("--integrators")) methods.push_back(read_spec("--integrators", name, types));
  std::vector<Stabilization::Kind> kinds;
  for (const std::string& word : args.all("--stabilizations")) kinds.push_back(stabilization_from(word));
  if (kinds.empty())
    kinds.push_back(gains ? Stabilization::Kind::baumgarte : plan.VariedScene::scene(1).run.stabilization.kind);
  for (const MethodSpec& method : methods)
    for (const Stabilization::Kind kind : kinds) {
      AtlasPanel panel{method, kind};
      try {
        const Scene first = plan.scene(1, panel);
        if (!(first.run.until > 0))
          throw UsageError(first.file + ": run.until: the scene has no end time, or 0; add it, or give --until 5");
        panel.adaptive = make_integrator(first.run, plan.loaded.registry)->info().adaptive;
      } catch (const SceneError& error) {
        panel.unsuited = error.what();
      }
      plan.panels.push_back(std::move(panel));
    }
  return plan;
}

}  // namespace lockstep
