// SPDX-License-Identifier: BSD-3-Clause
// Runs of a sweep, eight at a time: one run per vector lane.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <lockstep/sweep.h>

namespace lockstep {

/// Why a run of this scene cannot be in a lane: events, columns about steps and solutions, output at every step,
/// integrators other than dop853 and dopri5, and what Copies refuses; "" if it can. Throws what build_mechanism() throws.
LOCKSTEP_API std::string unsuited_for_lanes(const Scene&, const Registry&);

/// sweep_run for each of the scenes, which differ only in numbers; empty if one of them is not suited or they do not go
/// together: run them one by one. A run that fails is repeated by itself, for its reason. `go_on`: asked
/// again and again, with the time that all of them have reached; false breaks them off.
LOCKSTEP_API std::vector<SweepRun> sweep_lanes(std::span<const Scene> scenes, const Registry&, const Table& like,
                                               const std::function<bool(double t)>& go_on = {},
                                               std::vector<Table>* histories = nullptr);

}  // namespace lockstep
