// Projection: brings a state onto the constraints by the least move in the mass metric, positions, then velocities.
#pragma once

#include "framework/dynamics/evaluate/factor.h"

namespace lockstep {

struct ProjectReport {
  double before = 0, after = 0;      ///< |C|, metres
  double before_v = 0, after_v = 0;  ///< |Jh v + Ct|, m/s
  int rounds = 0;
  bool converged = true;
};

/// Scratch for the iterations; nothing is allocated when the links in force are those of the last call.
class LOCKSTEP_API Projection {
 public:
  /// `tolerance`: of |C|, m.
  explicit Projection(double tolerance) : tolerance_(tolerance) {}

  /// M d + Jh^T z = 0, Jh d = -C, q <- q (+) d, until |C| <= `goal`, m, but not below round-off; then the velocities to
  /// a tenth of it, m/s. A factor serves as long as a round takes nine tenths of |C| away (chord). The report says that
  /// it did not converge when more than the tolerance is left. Throws NonFiniteError, SolveError.
  ProjectReport project(Evaluation&, Factor&, State&, double goal);
  /// M dv + Jh^T z = 0, Jh dv = -(Jh v + Ct), until |Jh v + Ct| <= `goal`, m/s; gathers at the state. What is left of it:
  /// more than round-off where rows contradict one another.
  double project_velocity(Evaluation&, Factor&, State&, double goal);

 private:
  bool positions(Evaluation&, Factor&, State&, double goal, ProjectReport&);
  double velocities(const Evaluation&, Factor&, bool factored, State&, double goal);

  double tolerance_;
  VecX C_, Cd_, d_, lambda_, zero_;
};

}  // namespace lockstep
