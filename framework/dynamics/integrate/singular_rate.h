// SingularRate: the rates at a state that moves through a singular position.
#pragma once

#include <array>

#include <lockstep/dynamics.h>

namespace lockstep {

// In a singular position the rows do not determine the branch that the motion follows; a little before and a little behind they do.
//
//   a(+-d) at P(q (+) +-d v/|v|),  m(d) = (a(d) + a(-d))/2,  a = (15 m(d) - 6 m(2 d) + m(3 d))/10 + O(d^6)

/// Rates at a singular position, from both of its sides.
class LOCKSTEP_API SingularRate {
 public:
  /// Sizes the scratch for states like this one.
  void begin(const State&);
  /// Finds the rates from states 0.01, 0.02 and 0.03 rad (or parts of System::length) away on both sides along the
  /// velocity; accurate to about 1e-9. False, with `out` untouched, when the mechanism is at rest, when it cannot be
  /// brought onto the constraints or evaluated there (a law begins or ends), or when the sides disagree: then several
  /// motions continue from here.
  bool find(Dynamics&, const State&, StateRate& out);

 private:
  bool probe(Dynamics&, const State&, double delta, double time, StateRate& mean);

  State off_;  // the state to one side
  StateRate ahead_, behind_;
  std::array<StateRate, 3> mean_;
};

}  // namespace lockstep
