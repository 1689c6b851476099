// Increments: what a step adds to the state it began at, as one vector, so that implicit methods can calculate with it.
//
//   y = (dx, D of every slot | dv, dw of every slot | ds),   x = x0 + dx, e = e0 exp(D/2), v = v0 + dv, s = s0 + ds
//
// D is the rotation vector of the turn since the beginning of the step, in slot axes; it follows (framework/docs/solvers.md,
// section 8; Iserles, Munthe-Kaas, Norsett & Zanna, Acta Numerica 9 (2000) 215)
//
//   D' = w + (D x w)/2 + k D x (D x w),   k = (1 - (a/2) cot(a/2))/a^2,   a = |D|
#pragma once

#include "framework/mechanism/model/state.h"
#include "framework/foundation/support/export.h"

namespace lockstep {

/// Numbers in the increments of a state like this one.
inline Eigen::Index n_increments(const State& y) { return 2 * y.v.size() + y.s.size(); }
/// out = start (+) y; time, memory and links of `out` stay as they are.
LOCKSTEP_API void displace(const State& start, Eigen::Ref<const VecX> y, State& out);
/// d/dt of the increments y at the state `here` = start (+) y, whose rates are `k`.
LOCKSTEP_API void increment_rates(Eigen::Ref<const VecX> y, const State& here, const StateRate& k,
                                  Eigen::Ref<VecX> out);
/// The small increments y as the difference of two states near `at`, for ErrorNorm.
LOCKSTEP_API void as_difference(Eigen::Ref<const VecX> y, const State& at, StateRate& out);
/// Increments y since the beginning of a step that ended with y1, counted from that end.
LOCKSTEP_API void count_from(Eigen::Ref<const VecX> y1, Eigen::Index n_velocities, Eigen::Ref<VecX> y);
/// Largest rotation |D| of the increments, rad.
LOCKSTEP_API double largest_turn(Eigen::Ref<const VecX> y, Eigen::Index n_velocities);

}  // namespace lockstep
