// SPDX-License-Identifier: BSD-3-Clause
// The state of a mechanism, and what joints and forces see of it.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <lockstep/author/memory.h>
#include <lockstep/body.h>
#include <lockstep/math.h>

namespace lockstep {

// Inputs: what an evaluation sees of the mechanism. It is neither State nor System, so that jets and finite differences
// can evaluate a joint too.

/// Motion of a slot.
template <class T>
struct MotionT {
  Vec3T<T> x = Vec3T<T>::Zero();      ///< origin (centre of mass), world, m
  Mat3T<T> A = Mat3T<T>::Identity();  ///< slot axes -> world axes
  QuatT<T> e;                         ///< quaternion of A, unit
  Vec3T<T> v = Vec3T<T>::Zero();      ///< velocity of the origin, world, m/s
  Vec3T<T> w = Vec3T<T>::Zero();      ///< angular velocity, slot axes, rad/s
};
using Motion = MotionT<double>;  ///< motion of a slot in numbers

/// What joints and forces see of a state.
template <class T>
struct InputsT {
  T t{0};                               ///< time, s
  std::span<const MotionT<T>> motions;  ///< the ground first, then the slots
  std::span<const T> s;                 ///< integrated states, State::s
  std::span<const double> z;            ///< memory, State::z
  /// Rates of the counted angles (CountedAngle) that are coordinates of joints, rad/s; NaN for others; empty: none is.
  std::span<const double> angle_rates{};
  std::span<const double> angles{};  ///< the angles themselves, rad, without whole revolutions

  /// Motion of slot k, kGround for the ground.
  const MotionT<T>& slot(int k) const { return motions[static_cast<std::size_t>(k + 1)]; }  // kGround = -1 is the first
};
using Inputs = InputsT<double>;  ///< what joints and forces see of a state, in numbers

// State: a value that can be copied, kept and restored. All that must be undone when a step is rejected is stored here
// and nowhere else.

struct State;
struct StateRate;

/// The meaning of q and v of a State if they are not those of the slots: the coordinates of a formulation. Immutable.
class LOCKSTEP_API Coordinates {
 public:
  virtual ~Coordinates();
  virtual std::string_view name() const = 0;  ///< of the formulation
  virtual int n_q() const = 0;                ///< size of State::q
  virtual int n_v() const = 0;                ///< size of State::v
  virtual int n_slots() const = 0;            ///< number of slots that it moves
  /// Writes the motions of all slots to out[1], out[2], ...; out[0] is the ground, at rest, which the caller sets.
  virtual void motions(const State&, std::span<MotionT<double>> out) const = 0;
  /// Slots that laws move, all of them if nothing is free: StateRate::followed has their rates. Default: none.
  virtual std::span<const int> followed() const { return {}; }
  /// Whether constraint rows remain (loop-closure constraints, or those left by joints), from which states may drift.
  /// Default: none.
  virtual bool has_rows() const { return false; }
  /// Motion of one slot >= 0; costs as much as all that carry it.
  virtual Motion motion(const State&, int slot) const = 0;
  /// d/dt of q at the state's velocities.
  virtual void kinematic_rate(const State&, VecX& qd) const = 0;
  /// Moves q by h v, h in s.
  virtual void advance(State&, double h, const VecX& v) const = 0;
  /// Scales the quaternions among q to length one.
  virtual void normalize(State&) const = 0;
  /// Removes whole revolutions from angles that have made many of them, which would cost digits; the motions stay.
  /// Returns whether there was one. Default: there are no angles.
  virtual bool take_off_turns(State&) const { return false; }
  /// Change of the slots' motions under a small change `d` of q and v: 6 per slot, world axes. dx: of the centre of
  /// mass, m, and the rotation vector; dv: of its velocity, m/s, and of the angular velocity. `at`: what motions()
  /// writes. Slot coordinates give d itself.
  virtual void variations(const State&, std::span<const Motion> at, const StateRate& d, VecX& dx, VecX& dv) const = 0;
};

/// Everything that changes during a run. q and v belong to a formulation: integrators step them, the functions below
/// convert them to and from poses and twists, and all other code uses those functions.
struct State {
  double t = 0;  ///< time, s
  VecX q;        ///< 7 per slot: x (world, m), quaternion (scalar first) of the slot's frame at its centre of mass
  VecX v;        ///< 6 per slot: velocity (world, m/s), angular velocity (slot axes, rad/s)
  VecX s;        ///< other integrated states, each with a rate: controllers, speed laws, quadratures, counted angles
  VecX z;        ///< memory, not integrated (a switch, a foot on a curve); written only when a step is accepted
  std::vector<bool> modes;    ///< which joints are active, by joint number; changed only between steps
  std::vector<bool> watched;  ///< which unilateral joints become active when they are touched; others: false
  std::shared_ptr<const Coordinates> coordinates{};  ///< what q and v are, if not as above

  /// Pose of a slot in the world, slot >= 0; its quaternion as it is stored.
  LOCKSTEP_API Pose slot_pose(int slot) const;
  /// Velocity of a slot's origin, world, m/s, and its angular velocity, slot axes, rad/s.
  LOCKSTEP_API Twist slot_twist(int slot) const;
  /// Sets the pose of a slot in the world; p.q must be unit. Throws ModelError for a state in other coordinates than the
  /// slots' own.
  LOCKSTEP_API void set_slot_pose(int slot, const Pose& p);
  /// Sets the twist of a slot, as slot_twist() gives it. Throws likewise.
  LOCKSTEP_API void set_slot_twist(int slot, const Twist& o);

 private:
  [[noreturn]] LOCKSTEP_API void refuse_setting() const;
};

/// Motion of a slot, with the quaternion normalised; the ground is at rest at the origin.
LOCKSTEP_API Motion slot_motion(const State& state, int slot);

/// Writes a state for a checkpoint, in its coordinates; the Coordinates themselves are not written.
LOCKSTEP_API void put_state(const State&, Snapshot&);
/// Reads what put_state() wrote; the Coordinates stay. Throws ModelError if numbers are missing.
LOCKSTEP_API void get_state(State&, SnapshotReader&);

/// Moves q by h v, in the state's own coordinates; in the slots' own x += h v, e <- e exp(h w). h in s; v: 6 per slot,
/// m/s (world) and rad/s (slot axes). Time stays.
LOCKSTEP_API void advance_state(State&, double h, const VecX& v);
/// Scales the quaternions of q to length one.
LOCKSTEP_API void normalize_state(State&);
/// dq/dt at the state's velocities; in the slots' own coordinates 7 per slot: dx = v, de = (1/2) e w (1.8), from the
/// quaternion as it is stored, so that the exact flow keeps its length.
LOCKSTEP_API void kinematic_rate(const State&, VecX& qd);

/// Time derivatives of q, v and s, in the order of State; those of quaternions are (1/2) e w.
struct StateRate {
  VecX q,  ///< in the slots' own coordinates 7 per slot, m/s and 1/s
      v,   ///< likewise 6 per slot, m/s^2 (world) and rad/s^2 (slot axes)
      s;   ///< rates of the integrated states
  /// Of the slots that laws move (Coordinates::followed), 12 each: velocity and angular velocity, and their rates, world
  /// axes. Dynamics::rates writes them if it has their size (sized_like()). By them a method measures errors.
  VecX followed{};
  double largest_a = 0;      ///< in other coordinates than the slots' own: largest acceleration of a slot, m/s^2
  double largest_alpha = 0;  ///< and the largest angular acceleration, rad/s^2
};

/// Rates of the sizes that Dynamics::rates gives at a state, all zero.
LOCKSTEP_API StateRate sized_like(const State&);
/// The same into `out`; takes no memory if it has these sizes already.
LOCKSTEP_API void size_like(const State&, StateRate& out);

}  // namespace lockstep
