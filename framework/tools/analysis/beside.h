// Looks at states beside those of a run, which the run does not see.
#pragma once

#include <lockstep/dynamics.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>

namespace lockstep {

/// An evaluation and a factor of its own, for states in the bodies' own coordinates.
class Beside {
 public:
  Beside(Dynamics& of_run, System& system, const State& state)
      : of_run_(of_run),
        evaluation_(system, state),
        factor_(system, solver_, Formulation::omega, work_),
        project_(1e-8 * system.length()) {}

  /// The state that the velocity of `from` leads to in a time, put back onto the constraints. False: it cannot be.
  bool along(const State& from, double time, State& out);
  /// Its indicator; infinite where it cannot be had.
  double indicator_along(const State& from, double time, State& out);
  /// How near a state is to a singular position: it falls as the square of the distance.
  double indicator(const State&);
  /// Multipliers at a state, without forces that depend on them.
  const VecX& multipliers(const State&);

 private:
  void factor(const State&);

  Dynamics& of_run_;  // which says how many rows are redundant
  WorkCount work_;
  SchurSolver solver_;
  Evaluation evaluation_;
  Factor factor_;
  Projection project_;
  VecX c_, a_, lambda_;
};

/// The speed of the fastest body, rad/s; translations over the length of the mechanism.
double fastest(const Inputs&, double length);

/// The state of a sample in the bodies' own coordinates.
State in_slots(const Sample&);

/// Whether it has rows that a singular position could make redundant.
bool has_rows(const Sample&);

}  // namespace lockstep
