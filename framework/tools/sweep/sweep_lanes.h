// Runs of a sweep eight at a time, a run a vector lane.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <lockstep/sweep.h>

namespace lockstep {

struct LaneRuns {
  std::vector<SweepRun> runs;  ///< none: take them one by one
  std::string unsuited;        ///< why none of this sweep can be, in words; "" where only this group could not
};

/// As sweep_run for each of the scenes, which differ in numbers alone. Not suited: events, columns that look at every
/// step (angles count turns), output at every step, integrators but dop853 and dopri5, and what Copies cannot. A run
/// that fails is run again by itself, for its reason.
LOCKSTEP_API LaneRuns sweep_lanes(std::span<const Scene> scenes, const Registry&, const Table& like,
                                  const std::function<bool(const State&)>& go_on = {},
                                  std::vector<Table>* histories = nullptr);

}  // namespace lockstep
