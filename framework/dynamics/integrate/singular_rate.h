// SingularRate: the rates at a state that moves through a singular position. There the rows do not determine the branch
// that the motion follows; a little before and a little behind they do.
//
//   a(+-d) at P(q (+) +-d v/|v|),  m(d) = (a(d) + a(-d))/2,  a = (15 m(d) - 6 m(2 d) + m(3 d))/10 + O(d^6)
#pragma once

#include <array>

#include "framework/dynamics/evaluate/dynamics.h"

namespace lockstep {

class LOCKSTEP_API SingularRate {
 public:
  /// Sizes the scratch.
  void begin(const State&);
  /// Rates from states 0.01 rad (or of the scene's length) to both sides along the velocity, and twice and three times
  /// as far; right to about 1e-9. False, and nothing in `out`, when the mechanism is at rest, when it cannot be brought
  /// onto the constraints there, or when the sides disagree: then several motions go on from here.
  bool find(Dynamics&, const State&, StateRate& out);

 private:
  void probe_along_forces(Dynamics&, const State&);
  bool probe(Dynamics&, const State&, double delta, double time, StateRate& mean);

  State off_;  // the state beside it
  StateRate ahead_, behind_;
  std::array<StateRate, 3> mean_;
};

}  // namespace lockstep
