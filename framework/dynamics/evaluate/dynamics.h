// Dynamics: what an integrator asks of a mechanism: rates, projections, and matrices of its own.
#pragma once

#include <memory>
#include <optional>

#include "framework/dynamics/evaluate/projection.h"
#include "framework/dynamics/evaluate/reaction_iteration.h"
#include "framework/dynamics/evaluate/stabilization.h"

namespace lockstep {

struct DynamicsOptions {
  Formulation formulation = Formulation::omega;
  Stabilization stabilization;
};

/// Accelerations and multipliers at one state, with the evaluation that they belong to. Views of a Dynamics, valid
/// until that evaluates or projects again.
struct Solution : Evaluated {
  const Evaluation& evaluation;
  const Factor& factor;
  SolveReport report;  ///< without what costs time to know

  /// The whole report: residual, pivots, detector.
  SolveReport full_report() const;
};

class LOCKSTEP_API Dynamics {
 public:
  /// The system is set up if it was not. The solver must not be null.
  Dynamics(System&, std::unique_ptr<LinearSolver>, DynamicsOptions = {});
  Dynamics(const Dynamics&) = delete;
  Dynamics& operator=(const Dynamics&) = delete;

  const System& system() const { return system_; }
  /// Sets the system up when its description changed.
  void set_up() { system_.setup(); }
  const DynamicsOptions& options() const { return options_; }
  const LinearSolver& solver() const { return *solver_; }
  WorkCount& work() { return work_; }

  // -- at a state
  /// (2.1), (2.9) with the chosen stabilisation: d/dt of q, v and s. Throws NonFiniteError, SolveError.
  const Solution& rate(const State&, StateRate& out);
  /// The accelerations and multipliers alone.
  const Solution& evaluate(const State&);
  /// Rows and forces, unsolved; valid until the next evaluation or projection. Throws NonFiniteError.
  const Evaluation& gather(const State&);
  /// What links and forces see of this state, without rows; valid until the next call.
  const Inputs& inputs(const State&);
  /// |C|, m, and |Jh v + Ct|, m/s, over the rows in force (Evaluation::norm).
  double violation(const State&);
  double violation_v(const State&);

  // -- moving a state
  /// The least move in the mass metric onto C = 0, then onto Jh v = -Ct; quaternions normalised first.
  ProjectReport project(State&);
  /// The same until |C| <= `goal`, m (not below round-off): what is left at most is still the tolerance.
  ProjectReport project(State&, double goal);
  /// Only the velocities; what is left of |Jh v + Ct|, m/s: more than round-off where rows contradict one another.
  double project_velocity(State&);
  /// q (+) h v on the unit sphere. v: 6 per slot, m/s (world) and rad/s (slot axes).
  void advance(State& state, double h, const VecX& v) const { lockstep::advance(state, h, v); }
  void normalize(State& state) const { lockstep::normalize(state); }
  /// After an accepted step: what links and forces remember (State::z).
  void accept(State&);

  // -- matrices
  /// The matrix of this evaluation, factored; valid until the next evaluation or projection.
  Factor& factor(const Evaluation&);
  /// One for the caller to keep, without a matrix yet. This Dynamics must outlive it.
  Factor new_factor() { return {system_, *solver_, options_.formulation, work_}; }

 private:
  Evaluation& own(const State&);
  Evaluation& gathered(const State&);

  System& system_;
  std::unique_ptr<LinearSolver> solver_;
  DynamicsOptions options_;
  WorkCount work_;
  std::unique_ptr<Evaluation> evaluation_;  // null before the first state
  Factor factor_;
  Projection projection_;
  ReactionIteration reacting_;
  StateInputs inputs_;
  VecX a_, lambda_, c_, C_, Cd_;
  std::optional<Solution> solution_;
};

}  // namespace lockstep
