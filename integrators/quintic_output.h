// QuinticOutput: the motion inside a step from positions, velocities and accelerations at its two ends.
//
//   x, e: the polynomial of degree 5 that has p, p', p'' of both ends (e' = e w/2, e'' by (1.9)), e then normalised
//   v, w: its rate of change;   s: the polynomial of degree 3 that has s, s' of both ends
//
// Local error h^6 in positions, h^5 in velocities, h^4 in s. Implicit methods share it: the collocation polynomial of
// three stages has h^4 only.
#pragma once

#include "framework/mechanism/model/state.h"
#include "framework/foundation/support/export.h"

namespace lockstep {

class LOCKSTEP_API QuinticOutput {
 public:
  /// Sizes everything and forgets the step; `at` then gives this state.
  void begin(const State&);
  /// A step from a to b (unit quaternions, not farther from one another than half a turn), with d/dt of v and s there.
  void set(const State& a, const VecX& vd_a, const VecX& sd_a, const State& b, const VecX& vd_b, const VecX& sd_b);
  void forget() { h_ = 0; }
  /// The state at t; memory and links of the beginning. False when there is no step and t is not where it would begin.
  bool at(double t, State& out) const;

 private:
  State a_, b_;
  VecX vd_a_, vd_b_, sd_a_, sd_b_;
  double h_ = 0;  // 0: there is no step
};

}  // namespace lockstep
