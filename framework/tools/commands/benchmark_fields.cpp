// SPDX-License-Identifier: BSD-3-Clause
// Measured runs as results have them, for chart and advise.
#include "framework/tools/commands/benchmark.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace lockstep {
namespace {

const Fields<HistoryError>& error_fields() {
  static const Fields<HistoryError> kFields = [] {
    Fields<HistoryError> all{};
    for (const ErrorKind kind : kErrorKinds)
      all.add({to_string(kind), unit_of(kind), to_string(kind), [kind](const HistoryError& e) { return e.of(kind); }});
    return all;
  }();
  return kFields;
}

std::string error_text(const Json& error) {
  std::string text;
  for (const ErrorKind kind : kErrorKinds)
    text += (text.empty() ? "" : ", ") + digits_text<2>(error[to_string(kind)]) + " " + unit_of(kind);
  return text;
}

std::string runs_words(const Json& runs) {
  const auto failed = std::ranges::count_if(runs, [](const Json& r) { return r.contains("failure"); });
  const auto slow = std::ranges::count_if(runs, [](const Json& r) { return r.contains("stopped"); });
  const auto wrong = std::ranges::count_if(runs, [](const Json& r) { return r.contains("wrong"); });
  return fmt::format("{}{}{}{}", runs.size(), failed > slow ? fmt::format(", {} failed", failed - slow) : "",
                     slow > 0 ? fmt::format(", {} stopped as too slow", slow) : "",
                     wrong > 0 ? fmt::format(", {} wrong (energy or constraints)", wrong) : "");
}

std::string count_text(const Json& names) {
  return names.empty() ? "" : std::to_string(names.size()) + " combinations; increase --budget";
}

}  // namespace

const Fields<WorkPrecisionRun>& measured_run_fields() {
  using Run = WorkPrecisionRun;
  static const Fields<Run> kFields{
      {"integrator", "", "integrator", &Run::integrator},
      {"formulation", "", "formulation", [](const Run& r) { return to_string(r.formulation); }},
      {"stabilization", "", "stabilisation", [](const Run& r) { return to_string(r.stabilization); }},
      {"solver", "", "solver", [](const Run& r) { return needs_no_solver(r.used) ? "-" : r.solver; }},
      Field<Run>(
          "tolerance", "", "tolerance", [](const Run& r) { return r.adaptive ? r.setting : NAN; }, digits_text<3>)
          .optional(),
      Field<Run>(
          "step", "s", "step [s]", [](const Run& r) { return r.adaptive ? NAN : r.setting; }, digits_text<3>)
          .optional(),
      Field<Run>(
          "error", "error", [](const Run& r) { return r.done() ? std::optional(r.error) : std::nullopt; },
          error_fields(), error_text)
          .optional(),
      Field<Run>("failure", "", "failure", [](const Run& r) { return r.done() ? "" : r.failure; }).optional(),
      Field<Run>("stopped", "", "", &Run::given_up).optional(),  // as too slow
      Field<Run>("wrong", "", "", &Run::wrong).optional(),
      {"cpu", "s", "CPU [s]", &Run::cpu, digits_text<2>},
      {"evaluations", "", "evaluations", &Run::evaluations},
      {"factors", "", "", &Run::factors},
      {"steps", "", "steps", &Run::steps},
      {"rejected", "", "", &Run::rejected}};
  return kFields;
}

const Fields<CostAtError>& cost_fields() {
  static const Fields<CostAtError> kFields =
      Fields<CostAtError>{}
          .with([](const CostAtError& c) { return *c.run; }, measured_run_fields())
          .with({{"confirmed", "", "", &CostAtError::confirmed},
                 {"coarser_tried", "", "", [](const CostAtError& c) { return !c.upper_bound; }}});
  return kFields;
}

const Fields<WorkPrecision>& measurement_fields() {
  using Unsuited = WorkPrecision::Unsuited;
  static const Fields<Unsuited> kUnsuited{{"combinations", "", "combinations", &Unsuited::n},
                                          {"what", "", "such as", &Unsuited::what},
                                          {"why", "", "why", &Unsuited::why}};
  static const Fields<WorkPrecision> kFields{
      {"reference", "", "reference solution", &WorkPrecision::reference},
      {"second_reference", "", "  compared with", &WorkPrecision::second},
      {"agreement", "  differs by at most", &WorkPrecision::agreement, error_fields(), error_text},
      {"runs", "runs", &WorkPrecision::runs, measured_run_fields(), runs_words},
      {"not_tried", "", "unfinished", &WorkPrecision::left_out, count_text},
      {"unsuited", "left out", &WorkPrecision::unsuited, kUnsuited}};
  return kFields;
}

}  // namespace lockstep
