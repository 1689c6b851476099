// The state of a mechanism, and what links and forces see of it.
#pragma once

#include <span>
#include <vector>

#include <lockstep/body.h>
#include <lockstep/export.h>
#include <lockstep/math.h>

namespace lockstep {

// Inputs: what an evaluation sees of the mechanism. No State and no System: jets and differences can drive a link too.


/// Motion of a slot: x, v in the world; A slot -> world; e its quaternion; w in slot axes.
template <class T>
struct MotionT {
  Vec3T<T> x = Vec3T<T>::Zero();
  Mat3T<T> A = Mat3T<T>::Identity();
  QuatT<T> e;
  Vec3T<T> v = Vec3T<T>::Zero();
  Vec3T<T> w = Vec3T<T>::Zero();
};
using Motion = MotionT<double>;

/// What links and forces see of a state.
template <class T>
struct InputsT {
  T t{0};
  std::span<const MotionT<T>> motions;  ///< the ground first, then the slots
  std::span<const T> s;
  std::span<const double> z;

  const MotionT<T>& slot(int k) const { return motions[static_cast<std::size_t>(k + 1)]; }  // kGround = -1 is the first
};
using Inputs = InputsT<double>;


// State: a value. Copy it, keep it, rewind it. Whatever must be rolled back when a step is rejected lives here and
// nowhere else.


/// Coordinates belong to a formulation: integrators step them, the functions below read and write them as motions, and
/// everybody else asks those.
struct State {
  double t = 0;  ///< s
  VecX q;        ///< 7 per slot: x (world, m), quaternion (scalar first) of the slot's frame at its mass centre
  VecX v;        ///< 6 per slot: velocity (world, m/s), angular velocity (slot axes, rad/s)
  VecX s;        ///< integrated as well, each with a rate: controllers, speed laws, quadratures
  VecX z;        ///< remembered, not integrated: turn counters; written only when a step is accepted
  std::vector<bool> modes;    ///< which links are in force, by link number; changed only between steps
  std::vector<bool> watched;  ///< which unilateral links come into force when they are touched; others: false

  Pose slot_pose(int slot) const { return {q.segment<3>(7 * slot), Quat::from(q.segment<4>(7 * slot + 3))}; }
  Twist slot_twist(int slot) const { return {v.segment<3>(6 * slot), v.segment<3>(6 * slot + 3)}; }
  void set_slot_pose(int slot, const Pose& p) {
    q.segment<3>(7 * slot) = p.x;
    q.segment<4>(7 * slot + 3) = p.q.coefficients();
  }
  void set_slot_twist(int slot, const Twist& o) {
    v.segment<3>(6 * slot) = o.v;
    v.segment<3>(6 * slot + 3) = o.w;
  }
};

/// Motion of a slot, its quaternion normalised.
inline void read_motion(const State& state, int slot, Motion& out) {
  out.x = state.q.segment<3>(7 * slot);
  out.e = normalized(Quat::from(state.q.segment<4>(7 * slot + 3)));
  out.A = rotation(out.e);
  out.v = state.v.segment<3>(6 * slot);
  out.w = state.v.segment<3>(6 * slot + 3);
}
/// The same; of the ground: at rest.
inline Motion motion(const State& state, int slot) {
  Motion out;
  if (slot != kGround) read_motion(state, slot, out);
  return out;
}

/// q (+) h v: x += h v, e <- e exp(h w). v: 6 per slot, m/s (world) and rad/s (slot axes).
LOCKSTEP_API void advance(State&, double h, const VecX& v);
/// Quaternions back to length one.
LOCKSTEP_API void normalize(State&);
/// dq/dt at the state's velocities: dx = v, de = (1/2) e w (1.8), of the quaternion as it is, so that the exact flow keeps
/// its length.
LOCKSTEP_API void kinematic_rate(const State&, VecX& qd);

/// d/dt of q, v and s, in the same order; the quaternion rates are (1/2) q w.
struct StateRate {
  VecX q, v, s;
};

}  // namespace lockstep
