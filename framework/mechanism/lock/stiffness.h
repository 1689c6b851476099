// SPDX-License-Identifier: BSD-3-Clause
// Geometric stiffness of a lock: the derivative of its force Jh^T lambda with respect to the poses; multipliers and time
// are fixed (theory, (9.2), (9.3)). Laws enter by their values, and cost nothing extra.
#pragma once

#include <lockstep/author/relative.h>
#include <lockstep/detail/rows.h>

namespace lockstep {

/// (9.2) Adds the stiffness of translational rows. lt: multipliers of x, y, z (S axes), zero where there is no row.
///
///   n = A_S lt (O2 axes),  A2 n (world),  g = A1^T A2 n (O1 axes)         F = ( A2 n | uP x g | -A2 n | n x s )
LOCKSTEP_API void add_translation_stiffness(const Inputs& in, int slot1, int slot2, const MarkerMotion& P,
                                            const MarkerMotion& S, const Vec3& lt, TangentSum& out);

/// (9.3) Adds the stiffness of rotational rows. qD: imposed rotation; L: multipliers (l0, lr) of the four components
/// of e, with l0 = 0 for a lock, whose rows are vec(e).
///
///   F_th1 = +(1/2) A_P ( e0 lr - l0 ev - ev x lr )          F_th2 = -(1/2) A_SD ( e0 lr - l0 ev + ev x lr )
LOCKSTEP_API void add_rotation_stiffness(const Inputs& in, int slot1, int slot2, const MarkerMotion& P,
                                         const MarkerMotion& S, const Quat& qD, const Quat& L, TangentSum& out);

}  // namespace lockstep
