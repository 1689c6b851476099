// ReactionIteration: solutions with forces that depend on the reactions that they cause (friction).
#pragma once

#include "framework/dynamics/evaluate/factor.h"

namespace lockstep {

/// Scratch for the search; nothing is allocated when the mechanism is that of the last call.
class LOCKSTEP_API ReactionIteration {
 public:
  /// a and lambda solve M a + Jh^T lambda = f + x, Jh a = c, x = Evaluation::react(lambda). They come in solved without
  /// x, by this factor; all solutions are made by it. Throws SolveError naming the force that does not settle, and
  /// NonFiniteError.
  void solve(const Evaluation&, Factor&, const VecX& c, VecX& a, VecX& lambda, SolveReport&);

 private:
  struct Unsettled {
    const Evaluation& e;
    Factor& factor;
    const VecX& c;
    VecX &a, &lambda;
    SolveReport& report;
  };
  [[noreturn]] void diagnose(const Unsettled&, double left);

  VecX added_, added_before_, change_, change_before_, loaded_;  // x, g(x) - x, f + x: 6 per slot
};

}  // namespace lockstep
