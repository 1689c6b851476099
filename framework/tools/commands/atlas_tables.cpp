// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/atlas_tables.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <lockstep/text.h>
#include "framework/foundation/support/csv_cells.h"
#include "framework/tools/program/growing_file.h"

namespace lockstep {
namespace {

std::map<AtlasOutcome, long> counts_of(const AtlasPanel& panel) {
  std::map<AtlasOutcome, long> counts;
  for (const AtlasCell& c : panel.cells) ++counts[c.outcome];
  return counts;
}

long n_passed(const AtlasPanel& panel) {
  return std::ranges::count_if(panel.cells, [](const AtlasCell& c) { return c.passed > 0; });
}

}  // namespace

void write_atlas_cells(const std::string& file, const AtlasPlan& plan) {
  GrowingFile csv(file);
  csv.clear();
  std::string header = "integrator,stabilization";
  for (const Variable& v : plan.variables)
    header += "," + csv_cell(v.unit.empty() ? v.path : v.path + " [" + v.unit + "]");
  csv.append(header +
             ",outcome,error [m],energy imbalance,drift [m],singular positions,steps,rejected,cpu [s],reason\n");
  for (const AtlasPanel& panel : plan.panels) {
    for (std::size_t i = 0; i < panel.cells.size() && panel.unsuited.empty(); ++i) {
      const AtlasCell& c = panel.cells[i];
      const std::vector<std::size_t> at = plan.grid.at(static_cast<long>(i) + 1);
      std::string line = csv_cell(to_word(panel.integrator)) + "," + to_string(panel.stabilization);
      for (std::size_t k = 0; k < at.size(); ++k) line += "," + plain_text(plan.variables[k].values[at[k]]);
      const bool ran = c.outcome != AtlasOutcome::untried;
      line += fmt::format(",{},{},{},{},{},{},{},{},{}\n", csv_cell(words_of(c.outcome)),
                          ran && std::isfinite(c.error) ? text::number(c.error) : "", ran ? text::number(c.energy) : "",
                          ran ? text::number(c.drift) : "", c.passed, c.steps, c.rejected, text::number(c.cpu),
                          csv_cell(c.reason));
      csv.append(line);
    }
  }
  csv.commit();
}

nlohmann::ordered_json atlas_json(const AtlasPlan& plan) {
  nlohmann::ordered_json j;
  j["axes"] = j["maps"] = nlohmann::ordered_json::array();
  for (const Variable& v : plan.variables)
    j["axes"].push_back({{"name", v.path}, {"unit", v.unit}, {"values", axis_numbers(v)}});
  for (const AtlasPanel& panel : plan.panels) {
    nlohmann::ordered_json p = {{"integrator", to_word(panel.integrator)},
                                {"stabilization", to_string(panel.stabilization)}};
    if (!panel.unsuited.empty()) {
      p["left_out"] = panel.unsuited;
    } else {
      for (const auto& [outcome, n] : counts_of(panel)) p["counts"][words_of(outcome)] = n;
      nlohmann::ordered_json outcomes = nlohmann::ordered_json::array(), passed = nlohmann::ordered_json::array();
      const std::size_t n_y = plan.variables[1].values.size();
      for (std::size_t i = 0; i < panel.cells.size(); ++i) {
        if (i % n_y == 0) outcomes.push_back(nlohmann::ordered_json::array()), passed.push_back(outcomes.back());
        outcomes.back().push_back(words_of(panel.cells[i].outcome));
        passed.back().push_back(panel.cells[i].passed);
      }
      p["outcomes"] = std::move(outcomes), p["passed_singular_positions"] = std::move(passed);
      bool drawn = false;  // a method that is stable at every step has no line
      for (std::size_t k = 0; k < panel.limit_x.size(); ++k)
        drawn = drawn || (std::isfinite(panel.limit_x[k]) && std::isfinite(panel.limit_y[k]));
      if (drawn) p["limit"] = {{"x", panel.limit_x}, {"y", panel.limit_y}};
    }
    j["maps"].push_back(std::move(p));
  }
  return j;
}

void print_atlas_panels(const AtlasPlan& plan) {
  for (const AtlasPanel& panel : plan.panels) {
    if (!panel.unsuited.empty()) {
      fmt::print("  {:<34} left out: {}\n", panel.name(), panel.unsuited);
      continue;
    }
    std::string line;
    for (const auto& [outcome, n] : counts_of(panel))
      line += fmt::format("{}{} {}", line.empty() ? "" : ", ", n, words_of(outcome));
    if (const long n = n_passed(panel); n > 0)
      line += fmt::format("; {} passed singular positions with plain stages", n);
    fmt::print("  {:<34} {}\n", panel.name(), line);
  }
}

}  // namespace lockstep
