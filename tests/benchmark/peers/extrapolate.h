// SPDX-License-Identifier: BSD-3-Clause
// One-step integration of order 16 in extended precision: the midpoint rule, extrapolated in eight rows (Gragg,
// Bulirsch, Stoer). For truths only.
#pragma once

#include <functional>
#include <vector>

namespace lockstep::peers {

using Real = long double;
using RealVector = std::vector<Real>;
/// dy/dt at y (none of the mechanisms here depends on time).
using RateOf = std::function<void(const RealVector& y, RealVector& dy)>;

/// Takes y on by `length` in `steps` equal steps.
void extrapolate(const RateOf& rate, RealVector& y, Real length, int steps);

}  // namespace lockstep::peers
