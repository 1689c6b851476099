// SPDX-License-Identifier: BSD-3-Clause
// One run of a sweep with a further observer besides its recorder.
#pragma once

#include <functional>

#include <lockstep/sweep.h>

namespace lockstep {

/// An observer, and a function that is called at the end of the run, also of one that failed, with the mechanism and the
/// recorded columns. Both may be empty.
struct RunWatch {
  Observer* observer = nullptr;
  std::function<void(const Mechanism&, const Table&)> ended{};
};

/// Writes the results of an audit to the result of a run.
void judge(const Audit&, SweepRun&);

/// As sweep_run.
LOCKSTEP_API SweepRun watched_run(const Scene&, const Registry&, const Table& like,
                                  const std::function<bool(const State&)>& go_on, Table* history, const RunWatch&);

}  // namespace lockstep
