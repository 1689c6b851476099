// SPDX-License-Identifier: BSD-3-Clause
// The rows of one link of a system at inputs that a check varies.
#pragma once

#include <vector>

#include <lockstep/system.h>
#include "framework/tools/check/state_check.h"

namespace lockstep {

/// Gathers links of one pattern in one call. A row has C, Ct, Qhat, and the jacobian with 6 columns per slot of the
/// system; it holds `before` when the links begin to write. `outside`: whether they wrote outside of their rows.
std::vector<MatX> gathered(const System&, Group, const TestState&, double before = 0, bool* outside = nullptr);
MatX rows_of(const System&, const Lock&, const TestState&);
/// `sign` times C over time, along the motion without accelerations; the link's own states go on by their rates.
Curve C_along(const System&, const Lock&, TestState from, double sign);

}  // namespace lockstep
