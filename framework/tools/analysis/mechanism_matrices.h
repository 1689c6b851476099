// Masses and stiffness of a mechanism as sparse matrices in some of its unknown velocities.
#pragma once

#include <optional>
#include <string>

#include <lockstep/dynamics.h>
#include "framework/tools/analysis/unknowns.h"

namespace lockstep {

SparseMat mass_of(const System&, const Unknowns&);
/// K or D by pairs of slots.
SparseMat tangent_of(const TangentSum&, bool of_velocity, const Unknowns&);

/// Of the terms of a stiffness: what differences leave of a zero, of a link or force without a formula.
inline constexpr double kFlat = 1e-6;

/// How a combination w of rows that is zero, w J = 0, stops motions N c that the rows leave free: to second order
///
///     w . d^2C = c . G c,   G = N^T d(J^T w)/dx N                                            (9.23)
///
/// None if G is round-off: the rows depend on one another in the neighbouring positions too. `N`: in these unknowns, turns
/// as lengths; `w`: 1 per row of the table.
std::optional<MatX> stopping_form(const Evaluation&, const Unknowns&, const MatX& N, const VecX& w);

/// The bodies of a slot: "arm + bob".
std::string bodies_of(const Slot&);

}  // namespace lockstep
