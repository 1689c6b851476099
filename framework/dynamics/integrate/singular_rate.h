// SingularRate: the limits of a motion at a state in a singular position, or close to it.
#pragma once

#include <lockstep/dynamics.h>

namespace lockstep {

// In a singular position the rows do not determine the branch that the motion follows; a little before and a little
// behind they do. Of a place, a velocity or a rate x on the constraints, with P the projection:
//
//   x(+-d) at P(q (+) +-d v/|v|),  m(d) = (x(d) + x(-d))/2
//   x = (56 m(d) - 28 m(2d) + 8 m(3d) - m(4d))/35 + O(d^8)
//
// Without m(4d) it is x' = (15 m(d) - 6 m(2d) + m(3d))/10 + O(d^6), and x - x' an estimate of what both leave out. At
// the distance e, rounding leaves eps/e of the place, eps/e^2 of the velocity and eps/e^3 of the accelerations.

/// State and rates in a singular position, from both of its sides.
class LOCKSTEP_API SingularRate {
 public:
  static constexpr double kDelta = 0.04;  ///< d, rad: rounding and what the formula leaves are both small

  /// Sizes the scratch for states like this one.
  void begin(const State&);
  /// What both sides of a state are: those of a position that is closer than half of d, of none that is so close, or of
  /// one from which several motions continue.
  enum class Sides { agree, farther, differ };
  /// Finds the rates from states d to 4 d (or parts of System::length) away on both sides along the velocity, and the
  /// state on the constraints that they are of. `detector`: SolveReport::detector at the state, from which those beside
  /// it show how far the position is. With the state untouched `differ` is also the answer when the mechanism
  /// is at rest, or when it cannot be brought onto the constraints or evaluated there (a law begins or ends).
  Sides find(Dynamics&, State&, double detector, StateRate& out);
  double distance() const { return distance_; }  ///< of the position by the last find(), rad
  double error() const { return error_; }        ///< relative, of the accelerations that it found

 private:
  bool probe(Dynamics&, const State&, double angle, double time, std::size_t i, StateRate& out);

  struct Side {
    State at;
    StateRate rate;
  };
  Side ahead_, behind_;
  VecX v_;               // the limit of the velocities
  VecX shorter_;         // the accelerations without 4 d
  double detector_ = 0;  // geometric mean of those on both sides
  double largest_ = 0;   // acceleration
  double distance_ = 0, error_ = 0;
};

}  // namespace lockstep
