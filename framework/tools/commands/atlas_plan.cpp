// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/atlas_plan.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include <lockstep/error.h>
#include "framework/tools/commands/benchmark.h"
#include "framework/tools/commands/sweep_plan.h"

namespace lockstep {
namespace {

// "NAME=a:b:n:log" as a list of n values in geometric progression; anything else as it is.
std::string with_log(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || !text.ends_with(":log")) return text;
  const std::string range = text.substr(equals + 1, text.size() - equals - 5);
  const std::size_t first = range.find(':'), second = range.find(':', first + 1);
  const auto refuse = [&]() -> UsageError {
    return UsageError("--vary: \"" + text +
                      "\" is not a range; write NAME=a:b:n:log with a and b above 0, as in "
                      "run.step=1e-4:1e-1:20:log");
  };
  if (first == std::string::npos || second == std::string::npos) throw refuse();
  const auto number = [&](const std::string& word) {
    double x = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
    if (error != std::errc() || !(x > 0) || !std::isfinite(x)) throw refuse();
    return std::pair(x, std::string(end, word.data() + word.size()));
  };
  const auto [a, unit_a] = number(range.substr(0, first));
  const auto [b, unit_b] = number(range.substr(first + 1, second - first - 1));
  const auto [n, rest] = number(range.substr(second + 1));
  if (!rest.empty() || n != std::floor(n) || n < 2 || n > 1000 ||
      (!unit_b.empty() && !unit_a.empty() && unit_a != unit_b))
    throw refuse();
  const std::string unit = unit_a.empty() ? unit_b : unit_a;
  std::string list;
  for (int k = 0; k < static_cast<int>(n); ++k)
    list += fmt::format("{}{:.6g}{}", k == 0 ? "" : ",", a * std::pow(b / a, k / (n - 1)), unit);
  return text.substr(0, equals + 1) + list;
}

}  // namespace

Scene AtlasPlan::scene(long run, const AtlasPanel& panel) const {
  Scene s = vary_scene(loaded.scene, variables, grid.at(run), loaded.registry);
  override_settings(s.run, arguments, loaded.registry);
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
  Loaded loaded = read_with_plugins(args);
  std::vector<std::string> texts;
  for (const std::string& text : args.all("--vary")) texts.push_back(with_log(text));
  std::vector<Variable> variables =
      as_usage("--vary", [&] { return read_variables(texts, loaded.scene, loaded.registry); });
  if (variables.size() != 2) throw UsageError("--vary: a map has two axes; give --vary twice");
  bool gains = false;
  for (const Variable& v : variables) {
    axis_numbers(v);
    gains = gains || v.place.starts_with("run.stabilization.");
  }
  refuse_varied_options(args, variables);
  Grid grid = as_usage("--vary", [&] { return Grid({variables[0].values.size(), variables[1].values.size()}); });
  AtlasPlan plan{args, std::move(loaded), std::move(variables), std::move(grid), {}, {}, budget_of(args)};
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
  for (const std::string& word : args.all("--stabilizations")) kinds.push_back(read_stabilization(word));
  if (kinds.empty())
    kinds.push_back(gains ? Stabilization::Kind::baumgarte
                          : plan.scene(1, {methods.front(), {}}).run.stabilization.kind);
  if (args.all("--stabilizations").empty() && !gains) {
    Scene s = plan.loaded.scene;
    override_settings(s.run, args, plan.loaded.registry);
    kinds = {s.run.stabilization.kind};
  }
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
