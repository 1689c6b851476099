// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/finding.h>

#include <algorithm>
#include <array>

#include <lockstep/error.h>
#include <lockstep/log.h>
#include "framework/foundation/support/finding_kinds.h"

namespace lockstep {
namespace {

thread_local FindingScope* innermost = nullptr;

}  // namespace

const char* to_string(Severity severity) {
  constexpr const char* kWords[] = {"note", "warning", "doubt", "wrong"};
  return kWords[static_cast<int>(severity)];
}

std::span<const FindingKind* const> finding_kinds() {
  using namespace finding;
  constexpr auto all = [](auto&... kind) { return std::array{&kind...}; };
  static constexpr auto kinds =
      all(energy_not_conserved, constraints_drifted, requirement_broken, tolerance_not_reached, singular_passed,
          reactions_uncertain, inertia_lost, depends_on_share, not_certified, units_ignored, start_far, implausible,
          not_included, held_turn, quaternion_length, negative_stiffness, outputs_beyond_end, setting_unused,
          length_repeated, switches_unresolved, turns_uncertain, start_moved, start_speed_lost, start_changed,
          start_missed, singular_start, no_freedom, violated_in_run, long_turn, long_steps, event_at_zero, stop_passed,
          friction_damps, energy_not_judged, energy_suspect, event_missed, stiff, reactions_not_unique,
          nearly_redundant, units_assumed, analysis_note);
  return kinds;
}

const FindingKind& finding_kind(std::string_view code) {
  for (const FindingKind* kind : finding_kinds())
    if (kind->code == code) return *kind;
  throw ModelError("no finding has the code \"" + std::string(code) + "\"; finding_kinds() lists all");
}

std::string Finding::text() const {
  return (place.empty() ? "" : place + ": ") + message + (advice.empty() ? "" : "; " + advice);
}

std::vector<std::string> texts_of(const std::vector<Finding>& findings) {
  std::vector<std::string> texts;
  for (const Finding& f : findings) texts.push_back(f.text());
  return texts;
}

void report_finding(const Finding& f) {
  const auto is_same = [&f](const Finding& g) {
    return g.place == f.place && g.code() == f.code() && g.message == f.message;
  };
  for (FindingScope* scope = innermost; scope != nullptr; scope = scope->outer_) {
    if (!f.place.empty() && std::ranges::any_of(scope->found, is_same)) return;  // a place of a scene is read twice
    scope->found.push_back(f);
    if (!scope->hands_on_) return;
  }
  const bool listed = f.severity() == Severity::doubt && innermost != nullptr;
  (f.severity() == Severity::note || listed ? log_info : log_warning)(std::string(f.code()) + ": " + f.text());
}

FindingScope::FindingScope(bool hands_on) : hands_on_(hands_on), outer_(innermost) { innermost = this; }
FindingScope::~FindingScope() { innermost = outer_; }

}  // namespace lockstep
