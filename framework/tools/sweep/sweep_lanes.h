// SPDX-License-Identifier: BSD-3-Clause
// Runs of a sweep in vectorised batches of eight.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <lockstep/sweep.h>

namespace lockstep {

/// The reason why a run of this scene cannot be vectorised: events, columns about steps and solutions, output at every
/// step, integrators other than dop853 and dopri5, limits of Copies; "" if it can. Throws as build_mechanism() does.
LOCKSTEP_API std::string unsuited_for_lanes(const Scene&, const Registry&);

/// sweep_run for each of the scenes, which differ only in numbers; empty if one of them is not suited or they do not fit
/// together, for the reason `why`: run them one by one. A run that fails is repeated by itself, for its reason. `go_on` is
/// called with the time that all of them have reached; false ends them.
LOCKSTEP_API std::vector<SweepRun> sweep_lanes(std::span<const Scene> scenes, const Registry&, const Table& like,
                                               const std::function<bool(double t)>& go_on = {},
                                               std::vector<Table>* histories = nullptr, std::string* why = nullptr);

}  // namespace lockstep
