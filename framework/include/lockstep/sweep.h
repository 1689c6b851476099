// SPDX-License-Identifier: BSD-3-Clause
// A scene run many times.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/recorder.h>
#include <lockstep/scene.h>

namespace lockstep {

// Sweep: many runs of one mechanism, one row of results per run.

/// Results of one run.
struct SweepRun {
  std::vector<ColumnRange> columns;  ///< of the columns after the time, over the motion; none when nothing was recorded
  double t = 0;                      ///< last recorded time, s
  long steps = 0;                    ///< accepted steps
  double cpu = 0;                    ///< CPU time of this thread, from building to the end, s
  bool failed = false;               ///< `status` is then the reason, and `columns` do not count
  bool broken_off = false;           ///< `go_on` of sweep_run() ended it
  std::string status;                ///< "ok", or "stopped by 'landed'" if an event ended the run
  std::string energy;                ///< "conserved", "not conserved", "not judged"
  double imbalance = 0;  ///< of the energy, relative to the energy exchanged (Audit::imbalance_share)
  bool drifted = false;  ///< the constraint violation exceeded its limit
  double violation = 0;  ///< largest |C| after a step, m
  bool wrong = false;    ///< Audit::is_wrong()
  long passed = 0;       ///< singular configurations passed with unprojected stages
  double first_passed = 0;  ///< time of the first of them, s
  /// Findings about its scene, its start and the run, as of a single run.
  std::vector<Finding> findings;

  /// The last cell of its row: `status`, or "failed: " and the reason; if it is wrong, "wrong" instead of "ok", or
  /// "wrong: stopped by 'landed'"; then the singular configurations passed, and "doubtful: " and each doubt.
  LOCKSTEP_API std::string outcome() const;
};

/// Whether SweepRun::outcome() is that of a wrong run.
LOCKSTEP_API bool wrong_by(std::string_view outcome);

/// The columns that a scene records, with their units, without rows: the time, then its channels, or the places of
/// record_places(). Throws as build_mechanism() and Simulation(Mechanism) do.
LOCKSTEP_API Table recorded_columns(const Scene&, const Registry&);

/// Builds the scene, assembles its start and runs it to its end. It throws nothing: every failure is a result, also
/// columns other than those of `like`. `go_on`, if given, is called after every step and returns false to end the run;
/// the recorded table is written to `history`, if given.
LOCKSTEP_API SweepRun sweep_run(const Scene&, const Registry&, const Table& like,
                                const std::function<bool(const State&)>& go_on = {}, Table* history = nullptr);

/// Header of the CSV file of a sweep, with a line end:
/// "run,bodies.rod.mass [kg],t final [s],x final [m],x min [m],x max [m],
/// energy,imbalance,violation [m],steps,cpu [s],status".
LOCKSTEP_API std::string sweep_header(const std::vector<Variable>&, const Table& columns);
/// Row of the CSV file of a sweep, with a line end. The cells of results are empty if the run failed; the last is
/// SweepRun::outcome(). `choice`: index of the value of each variable.
LOCKSTEP_API std::string sweep_row(long run, const std::vector<Variable>&, const std::vector<std::size_t>& choice,
                                   const Table& columns, const SweepRun&);

}  // namespace lockstep
