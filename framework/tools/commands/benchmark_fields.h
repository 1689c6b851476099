// SPDX-License-Identifier: BSD-3-Clause
// Measured runs as results have them, for chart and advise.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "framework/foundation/support/lines.h"
#include "framework/tools/precision/pareto.h"
#include "framework/tools/program/result.h"

namespace lockstep {

/// A number with N digits, however small; "" of null.
template <int N>
std::string digits_text(const Json& x) {
  return x.is_null() ? std::string() : fmt::format("{:.{}g}", x.get<double>(), N);
}

inline const Fields<HistoryError> kErrorFields = [] {
  Fields<HistoryError> all{};
  for (const ErrorKind kind : kErrorKinds)
    all.add({to_string(kind), unit_of(kind), to_string(kind), [kind](const HistoryError& e) { return e.of(kind); }});
  return all;
}();

inline std::string error_text(const Json& error) {
  std::string text;
  for (const ErrorKind kind : kErrorKinds)
    text += (text.empty() ? "" : ", ") + digits_text<2>(error[to_string(kind)]) + " " + unit_of(kind);
  return text;
}

/// "683: 54 valid, 61 wrong, 164 stopped as too slow, 404 failed (most often: the step shrank ...)".
inline std::string runs_words(const WorkPrecision& w) {
  constexpr const char* kWords[] = {"valid", "accurate by chance", "wrong", "stopped as too slow", "failed"};
  long n[std::size(kWords)] = {};
  std::map<std::string, long> reasons;  // without their times and hints
  for (const WorkPrecisionRun& r : w.runs) {
    ++n[r.given_up ? 3 : !r.done() ? 4 : r.wrong ? 2 : counts(w, r) ? 0 : 1];
    const std::size_t at = r.failure.starts_with("t = ") ? r.failure.find(": ") + 2 : 0;
    if (!r.done() && !r.given_up) ++reasons[r.failure.substr(at, r.failure.find_first_of(";\n", at) - at)];
  }
  std::string text = std::to_string(w.runs.size()) + ":";
  for (std::size_t k = 0; k < std::size(n); ++k)
    if (n[k] > 0) text += fmt::format("{} {} {}", text.ends_with(':') ? "" : ",", n[k], kWords[k]);
  if (reasons.empty()) return text;
  return text + " (most often: " + std::ranges::max_element(reasons, {}, [](auto& r) { return r.second; })->first + ")";
}

inline std::string count_text(const Json& names) {
  return names.empty() ? "" : std::to_string(names.size()) + " combinations; increase --budget";
}

/// In one line: its errors and its cost, or why it failed.
inline std::string run_line(const WorkPrecisionRun& r) {
  if (!r.done()) return fmt::format("  {}: {}{}\n", label(r), r.given_up ? "" : "failed: ", first_line(r.failure));
  return fmt::format("  {}: error {}; CPU {:.2g} s, {} evaluations{}\n", label(r), error_text(kErrorFields(r.error)),
                     r.cpu, r.evaluations, r.wrong ? "; WRONG" : "");
}

/// Method, setting, errors, cost, or why it failed.
inline const Fields<WorkPrecisionRun> kMeasuredFields = [] {
  using Run = WorkPrecisionRun;
  return Fields<Run>{{"integrator", "", "integrator", &Run::integrator},
                     {"formulation", "", "", [](const Run& r) { return to_string(r.formulation); }},
                     {"formulation_used", "", "formulation", [](const Run& r) { return to_string(r.used); }},
                     {"stabilization", "", "stabilisation", [](const Run& r) { return to_string(r.stabilization); }},
                     {"solver", "", "solver", [](const Run& r) { return needs_no_solver(r.used) ? "-" : r.solver; },
                      [](const Json& solver) { return solver == "-" ? "not used" : solver.get<std::string>(); }},
                     {"tolerance", "", "tolerance", [](const Run& r) { return r.adaptive ? r.setting : NAN; },
                      digits_text<3>, kUnlessEmpty},
                     {"step", "s", "step [s]", [](const Run& r) { return r.adaptive ? NAN : r.setting; },
                      digits_text<3>, kUnlessEmpty},
                     {"error", "error", [](const Run& r) { return r.done() ? std::optional(r.error) : std::nullopt; },
                      kErrorFields, error_text, kUnlessEmpty},
                     {"failure", "", "failure", [](const Run& r) { return r.done() ? "" : r.failure; }, kUnlessEmpty},
                     {"stopped", "", "", &Run::given_up, kUnlessEmpty},  // as too slow
                     {"wrong", "", "", &Run::wrong, kUnlessEmpty},
                     {"cpu", "s", "CPU [s]", &Run::cpu, digits_text<2>},
                     {"evaluations", "", "evaluations", &Run::evaluations},
                     {"factors", "", "", &Run::factors},
                     {"steps", "", "steps", &Run::steps},
                     {"rejected", "", "", &Run::rejected}};
}();

/// The same with what is known of its cost.
inline const Fields<CostAtError> kCostFields =
    Fields<CostAtError>{}
        .with([](const CostAtError& c) { return *c.run; }, kMeasuredFields)
        .with({{"confirmed", "", "", &CostAtError::confirmed},
               {"coarser_tried", "", "", [](const CostAtError& c) { return !c.upper_bound; }}});

inline const Fields<WorkPrecision::Unsuited> kUnsuitedFields{
    {"combinations", "", "combinations", &WorkPrecision::Unsuited::n},
    {"what", "", "such as", &WorkPrecision::Unsuited::what},
    {"why", "", "why", &WorkPrecision::Unsuited::why}};
/// All runs, the references and how well they agree, what was left out.
inline const Fields<WorkPrecision> kMeasurementFields{
    {"reference", "", "reference solution", &WorkPrecision::reference},
    {"second_reference", "", "  compared with", &WorkPrecision::second},
    {"agreement", "  differs by at most", &WorkPrecision::agreement, kErrorFields, error_text},
    {"summary", "", "runs", runs_words},
    {"runs", "", &WorkPrecision::runs, kMeasuredFields},
    {"not_tried", "", "unfinished", &WorkPrecision::left_out, count_text},
    {"unsuited", "left out", &WorkPrecision::unsuited, kUnsuitedFields}};

}  // namespace lockstep
