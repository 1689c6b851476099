// SPDX-License-Identifier: BSD-3-Clause
// A run that ended, as a result.
#pragma once

#include <string>
#include <vector>

#include <lockstep/scene.h>
#include <lockstep/step_loop.h>
#include "framework/tools/program/check_dependencies.h"
#include "framework/tools/program/result.h"
#include "framework/tools/rank/singular_watch.h"
#include "framework/tools/record/row_envelope.h"

namespace lockstep {

/// An event that did not happen.
struct MissedEvent {
  EventRequest asked;
  EventCourse course;
  std::string unit;  ///< of its channel
};

/// Those of a run that ended. The requests are in the order of its events.
std::vector<MissedEvent> missed_events(Mechanism&, const StepLoop&);

/// A run that ended: complete, stopped by an event, or interrupted. It is filled during the run.
struct EndedRun {
  StepLoop& sim;
  const RunSettings& settings;
  const RowEnvelope& rows;                    ///< its table
  const Recorder& recorder;                   ///< its columns and their extremes
  const std::vector<PassedPosition>& passed;  ///< the first singular configurations passed without projected stages
  std::vector<std::string> frames_taken;      ///< places assumed
  Audit audit{};
  double seconds = 0;                     ///< wall-clock time
  bool interrupted = false;               ///< by the user
  std::string formulation{};              ///< at its end: "joint", "omega", "quaternion"
  std::vector<MissedEvent> missed{};      ///< events that did not happen
  std::vector<Finding> findings{};        ///< run_findings(), missed events, suspects_of()
  std::vector<std::string> not_unique{};  ///< columns of reactions
  std::vector<DecidedNear> near{};
  std::string assembled{};  ///< what assembling the start did; "" if little
  bool moved = false;       ///< whether assembling moved a body
  double resumed_at = NAN;  ///< of a checkpoint, s
  std::vector<std::string> notes{};  ///< on the pictures
  std::string certificate{};
};

inline constexpr std::size_t kResultsWidth = 88;  // letters of a line of results

/// The extremes of a column, in its unit.
struct ColumnEnds : ColumnRange {
  std::string name, unit;
  std::string at_least{}, at_most{};  ///< behind the numbers: " (crank = 50 mm)"
};
/// Makes 0 of what is rounding, by a relative tolerance, next to the largest number of its unit.
void drop_rounding(std::vector<ColumnEnds>&, double tolerance);
/// "-1.764 ... 2.698", without a unit.
std::string range_text(const ColumnEnds&);
/// As many columns as three lines hold, in cells of one width, and how many there are. `all`: what has all of them.
std::string results_text(const std::vector<ColumnEnds>&, const std::string& all);

/// That an event did not happen.
Finding finding_of(const MissedEvent&);
/// The likeliest causes of energy that was lost or gained; none if it was conserved or cannot be judged, or if none
/// applies. `n_passed`: singular configurations that the motion passed.
std::vector<Finding> suspects_of(const EndedRun&, System&, long n_passed);

/// As a result: status, method, counts, energy, violation, and each recorded column's last, least and largest value.
extern const Fields<EndedRun> kRunFields;

/// Columns of which a text gives the extremes: none, those that fit in three lines, or all in a table with their times.
enum class ColumnText { none, some, all };

/// What the run answers: time and steps, one line of checks, the extremes of columns. `verbose`: also the start, the
/// method and the energies.
std::string run_text(const EndedRun&, ColumnText, bool verbose);

}  // namespace lockstep
