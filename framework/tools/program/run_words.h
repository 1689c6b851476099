// SPDX-License-Identifier: BSD-3-Clause
// What is said of a run that ended: as lines for people, and as JSON for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include <lockstep/scene.h>
#include <lockstep/step_loop.h>
#include "framework/tools/program/commands.h"
#include "framework/tools/program/row_envelope.h"
#include "framework/tools/program/summary.h"
#include "framework/tools/rank/singular_watch.h"

namespace lockstep {

/// "1 row", "2 rows".
std::string rows_of(long n);

/// An event that did not happen.
struct MissedEvent {
  EventRequest asked;
  EventCourse course;
  std::string unit;  ///< of its channel
};

/// Those of a run that ended. The requests are in the order of its events.
std::vector<MissedEvent> missed_events(Mechanism&, const StepLoop&);

/// A run that ended, whichever way.
struct EndedRun {
  StepLoop& sim;
  const RunSettings& settings;
  const Audit& audit;
  double seconds = 0;        ///< of computing, by the clock
  bool interrupted = false;  ///< by the user
  const std::vector<PassedPosition>& passed;  ///< the first singular positions, with plain stages
  std::string formulation{};                  ///< of its steps: "joint", "omega", "quaternion"
  std::vector<MissedEvent> missed{};          ///< events that did not happen
  std::vector<Finding> findings{};            ///< run_findings(), missed events, suspects_of()
};

/// Those of the findings with this severity.
std::vector<Finding> of_severity(const std::vector<Finding>&, Severity);
/// Those of the findings of this kind.
std::vector<Finding> of_kind(const std::vector<Finding>&, const FindingKind&);
/// That an event did not happen.
Finding finding_of(const MissedEvent&);

/// What is printed of it.
std::string end_words(const EndedRun&, const Summary&);

/// The same as an object: status, method, counts, energy, drift, and each recorded column's last, least and largest
/// value.
nlohmann::ordered_json json_of(const EndedRun&, const RowEnvelope&);

}  // namespace lockstep
