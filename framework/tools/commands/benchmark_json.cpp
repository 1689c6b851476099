// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/benchmark_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace lockstep {
namespace {

nlohmann::ordered_json errors_of(const HistoryError& error) {
  auto j = nlohmann::ordered_json::object();
  for (const ErrorKind kind : kErrorKinds) {
    const double e = error.of(kind);
    j[to_string(kind)] = std::isfinite(e) ? nlohmann::ordered_json(e) : nlohmann::ordered_json(nullptr);
  }
  return j;
}

}  // namespace

nlohmann::ordered_json json_of(const WorkPrecisionRun& r) {
  nlohmann::ordered_json j = {{"integrator", r.integrator},
                              {"formulation", to_string(r.formulation)},
                              {"stabilization", to_string(r.stabilization)},
                              {"solver", r.solver},
                              {r.adaptive ? "tolerance" : "step", r.setting}};
  if (r.done())
    j["error"] = errors_of(r.error);
  else
    j["failure"] = r.failure;
  j.update({{"cpu", r.cpu},
            {"evaluations", r.evaluations},
            {"factors", r.factors},
            {"steps", r.steps},
            {"rejected", r.rejected}});
  return j;
}

nlohmann::ordered_json json_of(const CostAtError& c) {
  nlohmann::ordered_json j = json_of(*c.run);
  j["confirmed"] = c.confirmed, j["coarser_tried"] = !c.upper_bound;
  return j;
}

nlohmann::ordered_json json_of(const WorkPrecision& result) {
  nlohmann::ordered_json j = {{"reference", result.reference},
                              {"second_reference", result.second},
                              {"agreement", errors_of(result.agreement)},
                              {"runs", nlohmann::ordered_json::array()},
                              {"not_tried", result.left_out},
                              {"unsuited", nlohmann::ordered_json::array()}};
  for (const WorkPrecisionRun& run : result.runs) j["runs"].push_back(json_of(run));
  for (const WorkPrecision::Unsuited& u : result.unsuited) j["unsuited"].push_back({{"what", u.what}, {"why", u.why}});
  return j;
}

}  // namespace lockstep
