// SPDX-License-Identifier: BSD-3-Clause
// Parts of a sweep: one run with a further observer besides its recorder, and the beginning of its row.
#pragma once

#include <exception>
#include <functional>
#include <string>

#include <lockstep/sweep.h>

namespace lockstep {

struct StepSequence;

/// What a run is given besides its scene. Each may be empty.
struct RunWatch {
  Observer* observer = nullptr;
  /// Called at the end, also of a run that failed, with the mechanism and the recorded columns.
  std::function<void(const Mechanism&, const Table&)> ended{};
  StepSequence* steps = nullptr;  ///< that an adaptive method writes or repeats (SameSteps), if it saves all its data
};

/// As sweep_run.
LOCKSTEP_API SweepRun watched_run(const Scene&, const Registry&, const Table& like,
                                  const std::function<bool(const State&)>& go_on, Table* history, const RunWatch&);

/// The first cells of the row of a run, as sweep_row() writes them: its number and values.
LOCKSTEP_API std::string row_begin(long run, const std::vector<Variable>&, const std::vector<std::size_t>& choice);

/// What failed, without hints.
LOCKSTEP_API std::string fact_of(const std::exception&);

}  // namespace lockstep
