// SPDX-License-Identifier: BSD-3-Clause
// SingularRate: the limits of a motion at a state in a singular position, or close to it.
#pragma once

#include <algorithm>
#include <cmath>

#include <lockstep/dynamics.h>

namespace lockstep {

// In a singular position the rows do not determine the branch that the motion follows; a little before and a little
// behind they do. Of a place, a velocity, a rate or a multiplier x on the constraints, with P the projection:
//
//   x(+-d) at P(q (+) +-d v'/|v|),  v' the velocity at P(q (+) +-d/2 v/|v|),  m(d) = (x(d) + x(-d))/2
//   x = (56 m(d) - 28 m(2d) + 8 m(3d) - m(4d))/35 + O(d^8)
//
// Without m(4d) it is x' = (15 m(d) - 6 m(2d) + m(3d))/10 + O(d^6), and x - x' an estimate of what both leave out. At
// the distance e, rounding leaves eps/e of the place, eps/e^2 of the velocity and eps/e^3 of the accelerations.
//
// The root of the detector is proportional to the distance e and has its sign, so that it has such a limit too, which no
// proximal term covers: e is d times that over the root at d.
//
// On one branch the half difference o(d) = (x(d) - x(-d))/2 is odd, so that 2 o(d) - o(2d) is O(d^3); between two branches it
// is half of the jump from one to the other.
//
// A multiplier that grows as p/e has no limit. Its e o(e) is even, with the value p at e = 0, by the same weights.

/// Whether more rows depend on others at this state, at least nearly, than near it. Masses do not count, as they do in
/// the pivots of solvers. Of more than kDenseRows rows singular values below 1e-6 are lost.
bool loses_rank(Dynamics&, const State&);
/// Whether rows nearly depend on others at this state, not exactly; false of more than kDenseRows.
LOCKSTEP_API bool nearly_loses_rank(Dynamics&, const State&);

/// The SolveReport::detector below which a position counts as near a singular one, from where stages go onto the
/// constraints. `regular`: Redundancy::regular, small in all positions if bodies differ much in inertia; from 0.1 on the
/// limit is the same.
inline double near_singular_below(double regular) {
  constexpr double kSingular = 1e-2, kUnusual = 0.1;  // the largest limit, and its part of `regular`
  return std::min(kSingular, kUnusual * regular);
}

/// State, rates and multipliers in a singular position, from both of its sides.
class LOCKSTEP_API SingularRate {
 public:
  static constexpr double kDelta = 0.03;          ///< d, rad: rounding and what the formula leaves are both small
  static constexpr double kPoseRoundOff = 1e-13;  ///< rad: of a position after its projection, in a row of forty bays
  /// Relative, of the accelerations at this distance from a singular position, rad, if its position is off by so much.
  static double round_off(double distance, double off = kPoseRoundOff) {
    return off / (distance * distance * distance);
  }

  /// Sizes the scratch for states like this one.
  void begin(const State&);
  /// What both sides of a state are: those of a position that is closer than half of d, of none that is so close, or of
  /// one from which several motions continue.
  enum class Sides { agree, farther, differ };
  /// Finds the rates from states d to 4 d (or parts of System::length) away on both sides along the velocity, and the
  /// state on the constraints that they are of. `detector`: SolveReport::detector at the state, from which those near
  /// it show how far the position is. With the state untouched `differ` is also the answer when the mechanism
  /// is at rest, or when it cannot be brought onto the constraints or evaluated there (a law begins or ends).
  Sides find(Dynamics&, State&, double detector, StateRate& out);
  /// Of the position by the last find(), rad: by the detector alone if no state near it could be evaluated; HUGE_VAL at
  /// rest.
  double distance() const { return distance_; }
  double error() const { return error_; }  ///< relative, of the accelerations that it found
  /// The multipliers that it found, of a state in the slots' own coordinates; NaN if one has no limit.
  const VecX& multipliers() const { return lambda_; }
  double multiplier_error() const { return multiplier_error_; }  ///< relative, of those that have one
  /// Whether the root of the detector grows from d to 2 d: else no position is near, or proximal terms cover it.
  bool grows() const { return grows_; }
  /// The distance of the position by the roots on both sides, rad; distance() if they do not grow.
  double distance_by_sides() const { return grows_ ? kDelta * std::abs(root_) / slope_ : distance_; }

 private:
  bool probe(Dynamics&, const State&, double speed, double detector, std::size_t i, StateRate& out);
  void find_multipliers();

  struct Side {
    State at;
    StateRate rate;
    VecX lambda;
    double root;  // of the detector
  };
  Side ahead_, behind_;
  VecX v_;                       // the limit of the velocities
  std::vector<Motion> motions_;  // at the state
  VecX halfway_, odd_;           // v'; the jump
  VecX shorter_;                 // the accelerations without 4 d
  double root_ = 0, slope_ = 0;  // of the detector at the state, with its sign, and its change from there to d
  bool grows_ = false;
  double largest_ = 0;  // acceleration
  double distance_ = 0, error_ = 0;
  VecX lambda_, shorter_lambda_;  // the limit of the multipliers, and the one without 4 d
  VecX pole_;                     // p/d of each
  double largest_lambda_ = 0, multiplier_error_ = 0;
};

}  // namespace lockstep
