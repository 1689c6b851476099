// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/dynamics.h>

#include <lockstep/error.h>
#include <lockstep/solvers.h>
#include <lockstep/text.h>
#include "framework/dynamics/evaluate/projection_rule.h"
#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

Factor::Factor(const System& system, const LinearSolver& solver, Formulation formulation, WorkCount& work)
    : solver_(&solver), work_(&work), assembler_(system, formulation) {}

// Where rows hold that nearly depend on others J M^-1 J^T has the square of their condition: those are factored by QR.
void Factor::lay_out(const Evaluation& e) {
  static const DenseSolver kOfRows;
  const LinearSolver& solver = e.rows().held > 0 ? kOfRows : *solver_;
  layout_ = nullptr, of_equal_ = nullptr;
  assembler_.lay_out(e.rows(), solver.reads_rows());
  factorization_ = solver.analyse(assembler_.kkt().pattern);
  layout_ = e.layout();
  if (assembler_.direct()) return;
  for (VecX* x : {&f_, &a_}) x->setZero(assembler_.n());
  for (VecX* x : {&c_, &lambda_}) x->setZero(assembler_.m());
}

void Factor::compute(const Evaluation& e) {
  if (!fits(e)) lay_out(e);
  assembler_.update(e.rows(), e.inputs().motions);
  assembler_.set_redundant(e.redundant(), e.rows().held > 0 || e.nearly());
  factorization_->compute(assembler_.kkt());
  ++work_->factors;
  if (of_equal_ || e.redundant() <= 0 || assembler_.kkt().nearly) return;
  equal_ = std::make_unique<KktAssembler>(e.system(), Formulation::omega);
  equal_->lay_out(e.rows(), true), equal_->equal_masses(e.loops());
  of_equal_ = make_detector(equal_->kkt().pattern);
}

// Where rows are redundant, none of them nearly, the detector is that of equal bodies: it depends neither on masses nor
// on the solver.
void Factor::complete(const Evaluation& e, SolveReport& report) const {
  factorization_->complete(report);
  if (!of_equal_ || e.redundant() <= 0 || assembler_.kkt().nearly) return;
  equal_->read(e.rows()), equal_->set_redundant(e.redundant(), false);
  of_equal_->compute(equal_->kkt());
  of_equal_->complete(report);
}

void Factor::forget() {
  layout_ = nullptr, factorization_ = nullptr, of_equal_ = nullptr, equal_ = nullptr;
  assembler_.forget();
  for (VecX* x : {&f_, &c_, &a_, &lambda_}) *x = VecX();
}

SolveReport Factor::solve(const Evaluation& e, const VecX& f, const VecX& c, VecX& a, VecX& lambda) {
  return solve(e, f, c, false, a, lambda);
}

SolveReport Factor::solve_motion(const Evaluation& e, const VecX& f, const VecX& c, VecX& a, VecX& lambda) {
  return solve(e, f, c, true, a, lambda);
}

SolveReport Factor::solve(const Evaluation& e, const VecX& f, const VecX& c, bool moving, VecX& a, VecX& lambda) {
  if (!fits(e))
    throw ModelError("the factor was computed for other active joints than those of this evaluation; compute it again");
  if (f.size() != e.force().size() || c.size() != e.rows().n_rows)
    throw ModelError("Factor::solve: the right-hand sides have " + std::to_string(f.size()) + " and " +
                     std::to_string(c.size()) + " numbers, but " + std::to_string(e.force().size()) + " and " +
                     std::to_string(e.rows().n_rows) +
                     " are needed; resize them (6 per rigid group, 1 per constraint)");
  assembler_.read(e.rows());
  SolveReport report;
  if (assembler_.direct()) {
    report = factorization_->solve(assembler_.kkt(), f, c, a, lambda);
  } else {
    const std::span<const Motion> motions = e.inputs().motions;
    assembler_.load(f, c, motions, moving, f_, c_);
    report = factorization_->solve(assembler_.kkt(), f_, c_, a_, lambda_);
    a.resize(f.size());
    assembler_.unload(a_, lambda_, motions, e.rows().n_rows, a, lambda);
  }
  work_->corrections += report.corrections;
  return report;
}

void Factor::check(const Evaluation& e, const VecX& a, const VecX& lambda, const SolveReport& report) const {
  const double t = e.inputs().t;
  const auto when = [&] { return "t = " + text::number(t) + " s: "; };
  if (!a.allFinite() || !lambda.allFinite()) {
    e.check();  // names the object at fault
    throw NonFiniteError(when() + "the accelerations are not finite, but all constraints and forces are: solver '" +
                             std::string(solver_->name()) + "' failed here (use `dense`), or the motion diverged; " +
                             kShorterStep,
                         {.thing = {.kind = "mechanism"}, .t = t});
  }
  if (!report.contradictory) return;
  SolveReport full;
  if (complete(e, full); full.detector < kSmallPivot) return;  // a singular configuration, which may be passed
  VecX C, Cd;
  e.residuals(C, Cd);
  const double off = e.norm(C), relative = off / e.system().length();
  if (report.residual <= kLeftPerViolation * relative) return;
  throw SolveError(
      when() + passes::row_name(e.system(), e.rows(), report.worst_row) + " contradicts the others (residual " +
          text::brief(100 * report.residual) + " % of its right-hand side); " +
          (relative > kOnConstraints ? "this stage of the step violates the constraints by " + text::brief(off) +
                                           " m: take a smaller step; or two laws drive one coordinate"
                                     : std::string("two laws may drive one coordinate")) +
          or_against_stops(e.system(), e.rows()) + ": check the drives and masks of this joint and its neighbours",
      {.thing = thing_of_row(e.system(), e.rows(), report.worst_row), .t = t});
}

}  // namespace lockstep
