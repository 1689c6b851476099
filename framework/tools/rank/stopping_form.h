// SPDX-License-Identifier: BSD-3-Clause
// How rows that depend on one another stop motions to second order.
#pragma once

#include <optional>

#include <lockstep/dynamics.h>
#include "framework/tools/rank/unknowns.h"

namespace lockstep {

/// K or D by pairs of slots.
LOCKSTEP_API SparseMat tangent_of(const TangentSum&, bool of_velocity, const Unknowns&);

/// How a combination w of rows that is zero, w J = 0, stops motions N c that the rows leave free: to second order
///
///     w . d^2C = c . G c,   G = N^T d(J^T w)/dx N                                            (9.23)
///
/// None if G is slight beside its terms, as differences of a link without a formula leave a zero: the rows depend on
/// one another in the neighbouring positions too. `N`: in these unknowns, rotations as lengths; `w`: 1 per row of the
/// table.
LOCKSTEP_API std::optional<MatX> stopping_form(const Evaluation&, const Unknowns&, const MatX& N, const VecX& w);

}  // namespace lockstep
