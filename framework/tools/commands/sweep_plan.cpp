// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/sweep_plan.h"
#include "framework/foundation/support/finding_kinds.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/description/scene/reading.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/units.h"
#include "framework/tools/rank/doubts.h"

namespace lockstep {
namespace {

constexpr long kMostBuilt = 100;  // runs that are built to find the columns

// Throws for a variable that the scene does not have, if no run can be built with it.
void refuse_misplaced(const SweepPlan& plan, const std::string& reason) {
  for (const Variable& v : plan.variables)
    if (!v.near.empty())
      throw UsageError(
          fmt::format("--vary: \"{}\" is not in the scene, and no run can be built with it ({}); did you mean \"{}\"?",
                      v.path, reason, v.near));
}

// The columns of the first run that can be built, which are the same for all shards.
Table columns_of(const SweepPlan& plan) {
  const FindingScope unheard;  // the runs find the same
  std::optional<SceneError> first;
  const long n = plan.grid.n_runs(), n_built = std::min(n, kMostBuilt);
  for (long k = 0; k < n_built; ++k) {
    try {
      return recorded_columns(plan.scene(1 + k * (n - 1) / std::max(n_built - 1, 1l)), plan.loaded.registry);
    } catch (const SceneError& error) {
      if (!first) first = error;
    } catch (const ModelError& error) {
      if (!first) first = SceneError(error.what());
    }
  }
  refuse_misplaced(plan, first->what());
  throw *first;
}

// A length that is given in several places is usually meant to be one length.
void warn_left_behind(const std::vector<Variable>& variables, const Loaded& loaded) {
  for (const Variable& v : variables) {
    std::vector<std::string> places = left_behind(v, loaded.scene, loaded.registry);
    std::erase_if(places, [&](const std::string& place) {  // it varies too
      return std::any_of(variables.begin(), variables.end(), [&](const Variable& o) { return o.place == place; });
    });
    if (places.empty()) continue;
    report_finding({&finding::length_repeated, "",
                    fmt::format("--vary: the length at {} is also given at {}, which {} not vary with it", v.path,
                                first_of(places, 6), places.size() == 1 ? "does" : "do"),
                    "make it a parameter and write \"=name\" in these places, or name the point"});
  }
}

void refuse_varied_options(const Arguments& args, const std::vector<Variable>& variables) {
  for (const Variable& v : variables) {
    for (const std::string name :
         {"integrator", "solver", "step", "tolerance", "until", "output", "formulation", "stabilization"})
      if (!args["--" + name].empty() && (v.place == "run." + name || v.place.starts_with("run." + name + ".")))
        throw UsageError(fmt::format("--{}: \"{}\" varies; leave one of the two out", name, v.path));
    if ((!args["--planar"].empty() || args.has("--full")) && v.place == "planar")
      throw UsageError("--planar: \"planar\" varies; leave one of the two out");
  }
}

// In the unit that `text`, NAME=..., gives: six digits.
Variable as_written(Variable v, const std::string& text) {
  double size = 1, x = 0;
  for (const std::string& word : words_at(text.find(':') < text.size() ? ':' : ',', text.substr(text.find('=') + 1))) {
    const char* end = std::from_chars(word.data(), word.data() + word.size(), x).ptr;
    const std::string written(text::trimmed(std::string_view(end, word.data() + word.size())));
    const Measured one = in_si(1, written);
    if (end != word.data() && !written.empty() && one.problem.empty()) v.unit = written, size = one.value;
  }
  for (Value& value : v.values)
    if (value.number() != nullptr) value = Value(*number_in<double>(fmt::format("{:.6g}", *value.number() / size)));
  return v;
}

VariedScene read_varied(const Arguments& args, const std::string& option, const std::vector<std::string>& texts,
                        bool is_grid) {
  Loaded loaded = read_with_plugins(args);
  return as_usage(option, [&] {
    std::vector<Variable> variables = read_variables(texts, loaded.scene, loaded.registry);
    refuse_varied_options(args, variables);
    std::vector<Variable> shown;
    std::vector<std::size_t> sizes;
    for (const Variable& v : variables) {
      shown.push_back(as_written(v, texts[shown.size()]));
      if (is_grid) sizes.push_back(v.values.size());
    }
    return VariedScene{args, std::move(loaded), std::move(variables), std::move(shown), Grid(sizes)};
  });
}

}  // namespace

VariedScene read_varied(const Arguments& args) { return read_varied(args, "--vary", args.all("--vary"), true); }

VariedScene read_numbers(const Arguments& args) {
  std::vector<std::string> texts = args.all("--to");
  for (std::string& text : texts) text += "=0";
  VariedScene varied = read_varied(args, "--to", texts, false);
  warn_left_behind(varied.variables, varied.loaded);
  return varied;
}

VariedScene read_ranges(const Arguments& args) {
  std::vector<std::string> texts = args.all("--vary");
  for (std::string& text : texts) std::replace(text.begin(), text.end(), ':', ',');
  VariedScene varied = read_varied(args, "--vary", texts, false);
  for (const Variable& v : varied.variables) {
    const double *low = v.values.front().number(), *high = v.values.back().number();
    if (v.values.size() != 2 || low == nullptr || high == nullptr || !(*low < *high))
      throw UsageError("--vary: \"" + v.path + "\": expected NAME=a:b, a range from a smaller to a larger number");
  }
  warn_left_behind(varied.variables, varied.loaded);
  return varied;
}

Scene VariedScene::scene(long run) const {
  Scene s = vary_scene(loaded.scene, variables, grid.at(run), loaded.registry);
  override_settings(s.run, arguments, loaded.registry);
  return s;
}

std::string SweepPlan::runs_text(const std::vector<long>& runs) const {
  if (runs.size() == 1) return fmt::format("run {} ({})", runs[0], setting_text(shown, grid.at(runs[0])));
  std::string ranges;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const Variable& v = shown[k];
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (const long run : runs)
      if (const double* x = v.values[grid.at(run)[k]].number()) least = std::min(least, *x), most = std::max(most, *x);
    if (!(least <= most)) continue;  // words
    ranges += fmt::format("{}{} = {:.4g}", ranges.empty() ? " (" : ", ", v.path, least) +
              (least < most ? fmt::format("{}{:.4g}", runs.size() == 2 ? " and " : " ... ", most) : "") +
              (v.unit.empty() ? "" : " " + v.unit);
  }
  return fmt::format("{} runs{}", runs.size(), ranges.empty() ? "" : ranges + ")");
}

SweepPlan make_sweep_plan(const Arguments& args) {
  SweepPlan plan{read_varied(args)};
  if (!args["--shard"].empty()) plan.shard = as_usage("--shard", [&] { return read_shard(args["--shard"]); });
  warn_left_behind(plan.variables, plan.loaded);
  plan.plain_headers = args["--headers"].empty() ? !outputs_of(plan.loaded.scene).units : args["--headers"] == "plain";
  const Table recorded = columns_of(plan);
  for (const Column& c : recorded.columns()) plan.columns.add_column(c.name, plan.plain_headers ? "" : c.unit);
  return plan;
}

bool keeps_motion(const Arguments& args) { return !args["--histories"].empty() && !args["--report"].empty(); }

}  // namespace lockstep
