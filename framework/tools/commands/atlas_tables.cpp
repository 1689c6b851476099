// SPDX-License-Identifier: BSD-3-Clause
// The cells of an atlas as numbers: CSV, JSON, lines of text.
#include "framework/tools/commands/atlas_plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <lockstep/text.h>

namespace lockstep {
std::string atlas_csv(const AtlasPlan& plan) {
  const std::vector<Variable>& v = plan.variables;
  std::vector<std::vector<std::string>> lines{{"integrator", "stabilization", plan.title(0), plan.title(1), "outcome",
                                               "error [m]", "energy imbalance", "drift [m]", "singular positions",
                                               "steps", "rejected", "cpu [s]", "reason"}};
  for (const AtlasPanel& panel : plan.panels)
    for (std::size_t i = 0; i < panel.cells.size() && panel.unsuited.empty(); ++i) {
      const AtlasCell& c = panel.cells[i];
      const std::vector<std::size_t> at = plan.grid.at(static_cast<long>(i) + 1);
      const bool ran = c.outcome < AtlasOutcome::untried;
      lines.push_back({to_word(panel.integrator), to_string(panel.stabilization), plain_text(v[0].values[at[0]]),
                       plain_text(v[1].values[at[1]]), words_of(c.outcome),
                       ran && std::isfinite(c.error) ? text::number(c.error) : "", ran ? text::number(c.energy) : "",
                       ran ? text::number(c.drift) : "", std::to_string(c.passed), std::to_string(c.steps),
                       std::to_string(c.rejected), text::number(c.cpu), c.reason});
    }
  return csv_of(lines);
}

const Fields<AtlasPlan>& atlas_fields() {
  static const Fields<Variable> kAxis{
      {"name", "", "", &Variable::path}, {"unit", "", "", &Variable::unit}, {"values", "", "", axis_numbers}};
  using Shown = std::pair<const AtlasPlan*, const AtlasPanel*>;
  const auto of_cells = [](auto read) {
    return [read](const Shown& p) {
      std::vector<std::vector<std::remove_cvref_t<decltype(read(p.second->cells.front()))>>> rows;
      const std::size_t n_y = p.first->variables[1].values.size();
      if (p.second->unsuited.empty())
        for (std::size_t i = 0; i < p.second->cells.size(); ++i) {
          if (i % n_y == 0) rows.emplace_back();
          rows.back().push_back(read(p.second->cells[i]));
        }
      return rows;
    };
  };
  static const Fields<AtlasPanel> kLimit{{"x", "", "", &AtlasPanel::limit_x}, {"y", "", "", &AtlasPanel::limit_y}};
  const auto counts = [](const Shown& p) {
    std::map<AtlasOutcome, long> runs;
    Json all = Json::object();
    if (!p.second->unsuited.empty()) return all;
    for (const AtlasCell& c : p.second->cells) ++runs[c.outcome];
    for (const auto& [outcome, n] : runs) all[words_of(outcome)] = n;
    return all;
  };
  const auto passed = [](const Shown& p) {
    return std::ranges::count_if(p.second->cells, [](const AtlasCell& c) { return c.passed > 0; });
  };
  constexpr auto counts_text = +[](const Json& all) {
    std::string text;
    for (const auto& [outcome, n] : all.items()) text += (text.empty() ? "" : ", ") + n.dump() + " " + outcome;
    return text;
  };
  static const Fields<Shown> kPanel{
      {"integrator", "", "integrator", [](const Shown& p) { return to_word(p.second->integrator); }},
      {"stabilization", "", "stabilisation", [](const Shown& p) { return to_string(p.second->stabilization); }},
      {"left_out", "", "left out", [](const Shown& p) { return p.second->unsuited; }, kUnlessEmpty},
      {"counts", "", "runs", counts, counts_text, kUnlessEmpty},
      {"passed", "", "singular configurations passed", passed},
      {"outcomes", "", "", of_cells([](const AtlasCell& c) { return std::string(words_of(c.outcome)); }), kUnlessEmpty},
      {"passed_singular_positions", "", "", of_cells([](const AtlasCell& c) { return c.passed; }), kUnlessEmpty},
      {"limit", "",
       [](const Shown& p) {
         bool drawn = false;  // a method that is stable at every step has no line
         for (std::size_t k = 0; k < p.second->limit_x.size(); ++k)
           drawn = drawn || (std::isfinite(p.second->limit_x[k]) && std::isfinite(p.second->limit_y[k]));
         return drawn ? std::optional(*p.second) : std::nullopt;
       },
       kLimit, kUnlessEmpty}};
  static const Fields<AtlasPlan> kFields{{"axes", "", &AtlasPlan::variables, kAxis},
                                         {"maps", "methods",
                                          [](const AtlasPlan& plan) {
                                            std::vector<Shown> all;
                                            for (const AtlasPanel& panel : plan.panels) all.emplace_back(&plan, &panel);
                                            return all;
                                          },
                                          kPanel}};
  return kFields;
}

}  // namespace lockstep
