// Factor: the saddle-point matrix of an evaluation, factored, and solutions by it.
#pragma once

#include <memory>

#include "framework/dynamics/evaluate/evaluation.h"
#include "framework/dynamics/evaluate/kkt_assembler.h"
#include "framework/dynamics/solvers/linear_solver.h"

namespace lockstep {

/// Counters of work done, for reports and charts.
struct WorkCount {
  long evaluations = 0, factors = 0, projections = 0, corrections = 0;
};

///   | M   Jh^T | | a      |   | f |     f, a: 6 per slot (world; slot axes); c, lambda: 1 per row of the table
///   | Jh  -E   | | lambda | = | c |     E: proximal term, corrected away
///
/// Whoever holds one decides how long it serves. At the evaluation that it was computed from, solutions are exact. At
/// a later one with the same links in force the matrix is still the old one: M, and the directions Jh^T of the forces
/// are those of the old state (chord iterations, RATTLE).
class LOCKSTEP_API Factor {
 public:
  /// No matrix yet. All must outlive it; factors and corrections are counted in `work`.
  Factor(const System&, const LinearSolver&, Formulation, WorkCount& work);

  /// Factors the matrix of this evaluation. Symbolic work only when the description or the links in force changed;
  /// otherwise nothing is allocated. Throws SolveError.
  void compute(const Evaluation&);
  /// Any right side: projections, impulses, responses. `e`: computed from, or later. Throws ModelError where `e` has
  /// other links in force than the matrix, or nothing was computed.
  SolveReport solve(const Evaluation& e, const VecX& f, const VecX& c, VecX& a, VecX& lambda);
  /// The equations of motion: as solve(), and with what the formulation itself adds to f and c, (2.4)-(2.6).
  SolveReport solve_motion(const Evaluation& e, const VecX& f, const VecX& c, VecX& a, VecX& lambda);
  /// Fills what the report of the last solution leaves out since it costs time: residual, pivots, detector.
  void complete(SolveReport& report) const { factorization_->complete(report); }
  /// Throws NonFiniteError and SolveError, by name, when this solution is not finite or its rows contradict one another.
  void check(const Evaluation&, const VecX& a, const VecX& lambda, const SolveReport&) const;

 private:
  void lay_out(const Evaluation&);
  SolveReport solve(const Evaluation&, const VecX& f, const VecX& c, bool moving, VecX& a, VecX& lambda);
  bool fits(const Evaluation& e) const { return layout_ && (layout_ == e.layout() || *layout_ == *e.layout()); }

  const LinearSolver* solver_;
  WorkCount* work_;
  KktAssembler assembler_;
  std::unique_ptr<Factorization> factorization_;
  std::shared_ptr<const Evaluation::Layout> layout_;  // null: no matrix yet
  VecX f_, c_, a_, lambda_;  // in the formulation's own unknowns
};

}  // namespace lockstep
