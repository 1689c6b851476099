// The state of a mechanism, and what links and forces see of it.
#pragma once

#include <span>
#include <vector>

#include <lockstep/body.h>
#include <lockstep/export.h>
#include <lockstep/math.h>

namespace lockstep {

// Inputs: what an evaluation sees of the mechanism. It is neither State nor System, so that jets and finite differences
// can evaluate a link too.

/// Motion of a slot.
template <class T>
struct MotionT {
  Vec3T<T> x = Vec3T<T>::Zero();      ///< origin (mass centre), world, m
  Mat3T<T> A = Mat3T<T>::Identity();  ///< slot axes -> world axes
  QuatT<T> e;                         ///< quaternion of A, unit
  Vec3T<T> v = Vec3T<T>::Zero();      ///< velocity of the origin, world, m/s
  Vec3T<T> w = Vec3T<T>::Zero();      ///< angular velocity, slot axes, rad/s
};
using Motion = MotionT<double>;  ///< motion of a slot in numbers

/// What links and forces see of a state.
template <class T>
struct InputsT {
  T t{0};                               ///< time, s
  std::span<const MotionT<T>> motions;  ///< the ground first, then the slots
  std::span<const T> s;                 ///< integrated states, State::s
  std::span<const double> z;            ///< memory, State::z

  /// Motion of slot k, kGround for the ground.
  const MotionT<T>& slot(int k) const { return motions[static_cast<std::size_t>(k + 1)]; }  // kGround = -1 is the first
};
using Inputs = InputsT<double>;  ///< what links and forces see of a state, in numbers

// State: a value. It can be copied, kept and restored. Whatever must be undone when a step is rejected is stored here
// and nowhere else.

/// Everything that changes during a run. The layout of q and v belongs to the formulation: integrators step them, the
/// functions below convert them to and from poses and twists, and all other code uses those functions.
struct State {
  double t = 0;  ///< time, s
  VecX q;        ///< 7 per slot: x (world, m), quaternion (scalar first) of the slot's frame at its mass centre
  VecX v;        ///< 6 per slot: velocity (world, m/s), angular velocity (slot axes, rad/s)
  VecX s;        ///< other integrated states, each with a rate: controllers, speed laws, quadratures
  VecX z;        ///< memory, not integrated: turn counters; written only when a step is accepted
  std::vector<bool> modes;    ///< which links are in force, by link number; changed only between steps
  std::vector<bool> watched;  ///< which unilateral links come into force when they are touched; others: false

  /// Pose of a slot in the world, slot >= 0; its quaternion as it is stored.
  Pose slot_pose(int slot) const { return {q.segment<3>(7 * slot), Quat::from(q.segment<4>(7 * slot + 3))}; }
  /// Velocity of a slot's origin, world, m/s, and its angular velocity, slot axes, rad/s.
  Twist slot_twist(int slot) const { return {v.segment<3>(6 * slot), v.segment<3>(6 * slot + 3)}; }
  /// Sets the pose of a slot in the world; p.q must be unit.
  void set_slot_pose(int slot, const Pose& p) {
    q.segment<3>(7 * slot) = p.x;
    q.segment<4>(7 * slot + 3) = p.q.coefficients();
  }
  /// Sets the twist of a slot, as slot_twist() gives it.
  void set_slot_twist(int slot, const Twist& o) {
    v.segment<3>(6 * slot) = o.v;
    v.segment<3>(6 * slot + 3) = o.w;
  }
};

/// Writes the motion of a slot >= 0 to `out`, with the quaternion normalised.
inline void read_motion(const State& state, int slot, Motion& out) {
  out.x = state.q.segment<3>(7 * slot);
  out.e = normalized(Quat::from(state.q.segment<4>(7 * slot + 3)));
  out.A = rotation(out.e);
  out.v = state.v.segment<3>(6 * slot);
  out.w = state.v.segment<3>(6 * slot + 3);
}
/// Motion of a slot, with the quaternion normalised; the ground is at rest at the origin.
inline Motion slot_motion(const State& state, int slot) {
  Motion out;
  if (slot != kGround) read_motion(state, slot, out);
  return out;
}

/// Moves q by h v: x += h v, e <- e exp(h w). h in s; v: 6 per slot, m/s (world) and rad/s (slot axes). Time stays.
LOCKSTEP_API void advance_state(State&, double h, const VecX& v);
/// Scales the quaternions of q to length one.
LOCKSTEP_API void normalize_state(State&);
/// dq/dt at the state's velocities, 7 per slot: dx = v, de = (1/2) e w (1.8), from the quaternion as it is stored, so
/// that the exact flow keeps its length.
LOCKSTEP_API void kinematic_rate(const State&, VecX& qd);

/// Time derivatives of q, v and s, in the order of State; those of quaternions are (1/2) e w.
struct StateRate {
  VecX q,  ///< 7 per slot, m/s and 1/s
      v,   ///< 6 per slot, m/s^2 (world) and rad/s^2 (slot axes)
      s;   ///< rates of the integrated states
};

}  // namespace lockstep
