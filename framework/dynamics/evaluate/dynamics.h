// Dynamics: everything that an integrator may ask of a mechanism.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "framework/dynamics/evaluate/stabilization.h"
#include "framework/dynamics/solvers/linear_solver.h"
#include "framework/mechanism/system/system.h"

namespace lockstep {

class Matrix;

/// Counters of work done, for reports and charts.
struct WorkCount {
  long evaluations = 0, factors = 0, projections = 0, corrections = 0;
};

struct ProjectReport {
  double before = 0, after = 0;      ///< |C|, metres
  double before_v = 0, after_v = 0;  ///< |Jh v + Ct|, m/s
  int rounds = 0;
  bool converged = true;
};

struct DynamicsOptions {
  Formulation formulation = Formulation::omega;
  Stabilization stabilization;
};

class LOCKSTEP_API Dynamics {
 public:
  /// The system is set up if it was not. The solver must not be null.
  Dynamics(System& system, std::unique_ptr<LinearSolver> solver, DynamicsOptions options = {});
  ~Dynamics();

  const System& system() const { return system_; }
  /// Sets the system up when its description changed.
  void set_up() { system_.setup(); }
  const DynamicsOptions& options() const { return options_; }
  const LinearSolver& solver() const { return *solver_; }

  /// (2.1), (2.9) with the chosen stabilisation: d/dt of q, v and s at this state. Throws NonFiniteError, SolveError.
  void rate(const State&, StateRate& out);
  /// The same, keeping a, lambda and rows for `values()`.
  const Evaluated& evaluate(const State&);
  /// Of the last rate() or evaluate().
  const Evaluated& values() const { return *values_; }
  const Inputs& inputs() const { return in_; }

  /// Least mass-weighted move onto C = 0 (exponential update), then onto Jh v = -Ct; quaternions normalised first.
  ProjectReport project(State&);
  /// The same until |C| <= `goal`, m (not below round-off): what is left at most is still the tolerance.
  ProjectReport project(State&, double goal);
  /// Only the velocity level; what is left of |Jh v + Ct|, m/s: more than round-off where rows contradict one another.
  double project_velocity(State&);
  /// |C| in metres: over the rows of the present set (framework/docs/solvers.md); and |Jh v + Ct| in m/s.
  double violation(const State&);
  double violation_v(const State&);

  /// q (+) h v on the unit sphere (exponential update).
  void advance(State&, double h, const VecX& v) const;
  void normalize(State&) const;
  /// After an accepted step.
  void accept(State&);

  WorkCount& work() { return work_; }
  const SolveReport& last_solve() const;

  /// What links and forces see of this state; rows and force stay as they were gathered last.
  const Inputs& look(const State&);

  // -- forces that depend on the present reactions (friction)
  const std::vector<const Force*>& reacting() const { return reacting_; }  ///< none: one solution an evaluation
  /// f += what they add at these multipliers, one a row, at the state gathered last.
  void react(const VecX& lambda, VecX& f) const;

  // -- what assembly and analyses build on
  /// Rows and forces at this state; afterwards rows() and force() are complete.
  void gather(const State&);
  const RowTable& rows() const { return rows_; }
  const VecX& force() const { return f_; }
  /// M a + Jh^T lambda = f, Jh a = c at the last gathered state (6 a slot; particles' last three are 0). Counts a
  /// factor when the state is new.
  const SolveReport& solve(const VecX& f, const VecX& c, VecX& a, VecX& lambda);
  /// For iterations with one matrix: solve() takes the matrix factored last (its J and M) at the state gathered now.
  void keep_factor() { factored_ = true; }
  /// C, Ct and Jh v + Ct of the gathered rows, one a row.
  void residuals(VecX& C, VecX& Cd) const;
  /// q moved by d (6 a slot: x in the world, turn in slot axes; exponential update).
  void move(State&, const VecX& d) const;
  /// Largest |c| with the norm of framework/docs/solvers.md: metres, radians times L, half turns times 2 L.
  double norm(const VecX& c) const;

 private:
  void prepare(const State&);
  void see(const State&);
  void gather_unchecked(const State&);
  void refactor();
  const SolveReport& solve_loaded(const VecX& f, const VecX& c, bool moving, VecX& a, VecX& lambda);
  void find_reactions(const State&);
  [[noreturn]] void blame_reactions(const State&, double left);
  void check_gathered(const State&) const;
  [[noreturn]] void blame_rates(const State&, const VecX& sd) const;
  void check_solved(const State&) const;
  void project_position(State&, double goal, ProjectReport&);
  double velocity_rounds(State&, double goal);
  void update_velocities(const State&);

  System& system_;
  std::unique_ptr<LinearSolver> solver_;
  DynamicsOptions options_;
  std::unique_ptr<Matrix> matrix_;
  std::unique_ptr<Factorization> factor_;
  std::vector<Motion> motions_;
  std::vector<bool> modes_;
  bool laid_out_ = false, factored_ = false;
  long revision_ = -1;       // of the system that was laid out
  RowTable rows_;
  VecX f_, c_, a_, lambda_, C_, Cd_, zero_, d_;
  VecX solved_f_, solved_c_, solved_a_, solved_lambda_;  // in the formulation's own unknowns
  std::vector<const Force*> reacting_;
  VecX added_, added_before_, change_, change_before_, loaded_;  // of find_reactions
  Inputs in_;
  std::unique_ptr<Evaluated> values_;
  mutable SolveReport solve_report_;
  mutable bool report_complete_ = false;
  WorkCount work_;
};

}  // namespace lockstep
