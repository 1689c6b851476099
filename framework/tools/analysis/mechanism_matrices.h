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

/// dv of displacements that rest in axes which turn with a spin, world: Om x dx, and W x dth in slot axes (9.20).
SparseMat carried_by(const Vec3& spin, const System&, const State&);

/// How a combination w of rows that is zero, w J = 0, stops motions N c that the rows leave free: to second order
///
///     w . d^2C = c . G c,   G = N^T d(J^T w)/dx N                                            (9.23)
///
/// None if G is slight beside its terms, as differences of a link without a formula leave a zero: the rows depend on one
/// another in the neighbouring positions too. `N`: in these unknowns, turns as lengths; `w`: 1 per row of the table.
std::optional<MatX> stopping_form(const Evaluation&, const Unknowns&, const MatX& N, const VecX& w);

/// The bodies of a slot: "arm + bob".
std::string bodies_of(const Slot&);

}  // namespace lockstep
