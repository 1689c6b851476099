#include <lockstep/dynamics.h>

#include <utility>

#include <lockstep/error.h>
#include <lockstep/solvers.h>
#include <lockstep/text.h>
#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

namespace {

constexpr double kOn = 1e-7;  // of that length: nearer than this is on the constraints

}  // namespace

Factor::Factor(const System& system, const LinearSolver& solver, Formulation formulation, WorkCount& work)
    : solver_(&solver), work_(&work), assembler_(system, formulation) {}

// Where rows hold that nearly depend on others J M^-1 J^T has the square of their condition: those are factored by QR.
void Factor::lay_out(const Evaluation& e) {
  static const DenseSolver kOfRows;
  const LinearSolver& solver = e.rows().held > 0 ? kOfRows : *solver_;
  layout_ = nullptr;
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
  factorization_->compute(assembler_.kkt());
  ++work_->factors;
  if (!rested_.layout) return;
  const Learned before = std::exchange(rested_, {});
  if (!same(before.layout, e)) return;
  SnapshotReader numbers(before.numbers);
  factorization_->restore(numbers);
  factorization_->compute(assembler_.kkt());  // sees this matrix by what it knew
}

void Factor::rest() {
  if (!layout_) return;
  keep(rested_);
  layout_ = nullptr, factorization_ = nullptr;
  assembler_.forget();
  for (VecX* x : {&f_, &c_, &a_, &lambda_}) *x = VecX();
}

void Factor::save(const Evaluation& e, Snapshot& out) const {
  Snapshot learned;
  const bool any = factorization_ && fits(e), rests = !any && same(rested_.layout, e);
  if (any) factorization_->save(learned);
  out.put(any || rests ? 1 : 0), out.put_part(rests ? rested_.numbers : learned);
}

void Factor::restore(const Evaluation& e, SnapshotReader& in) {
  const bool any = in.get_flag();
  SnapshotReader learned = in.get_part();
  layout_ = nullptr, rested_ = {};
  if (!any) return;
  compute(e);
  factorization_->restore(learned);
}

void Factor::keep(Learned& out) const {
  if (!layout_ && rested_.layout) {
    out = rested_;
    return;
  }
  out.layout = layout_;
  out.numbers.clear();
  if (layout_) factorization_->save(out.numbers);
}

// Where matrices of other links were factored in between, the next one is laid out anew. Where no memory is left, it is
// too, and takes up what was learned then.
void Factor::put_back(Learned in) noexcept {
  if (rested_.layout) {
    layout_ = nullptr, rested_ = std::move(in);
    return;
  }
  if (!layout_) return;
  if (!in.layout || (in.layout != layout_ && *in.layout != *layout_)) {
    layout_ = nullptr;
    return;
  }
  try {
    SnapshotReader numbers(in.numbers);
    factorization_->restore(numbers);
  } catch (const std::exception&) {
    layout_ = nullptr, rested_ = std::move(in);
  }
}

SolveReport Factor::solve(const Evaluation& e, const VecX& f, const VecX& c, VecX& a, VecX& lambda) {
  return solve(e, f, c, false, a, lambda);
}

SolveReport Factor::solve_motion(const Evaluation& e, const VecX& f, const VecX& c, VecX& a, VecX& lambda) {
  return solve(e, f, c, true, a, lambda);
}

SolveReport Factor::solve(const Evaluation& e, const VecX& f, const VecX& c, bool moving, VecX& a, VecX& lambda) {
  if (!fits(e))
    throw ModelError("a factor was computed with other links in force than it is asked to solve with; compute it anew");
  if (f.size() != e.force().size() || c.size() != e.rows().n_rows)
    throw ModelError("Factor::solve: right sides of " + std::to_string(f.size()) + " and " + std::to_string(c.size()) +
                     " numbers where " + std::to_string(e.force().size()) + " (6 per slot) and " +
                     std::to_string(e.rows().n_rows) + " (1 per row) are needed; size them");
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
    e.check();  // names the culprit
    throw NonFiniteError(when() + "the accelerations are not finite although every row and force is; solver '" +
                             std::string(solver_->name()) +
                             "' failed on this pose (try `dense`), or the motion has blown up: " + kShorterStep,
                         {.thing = {.kind = "mechanism"}, .t = t});
  }
  if (!report.contradictory) return;
  VecX C, Cd;
  e.residuals(C, Cd);
  const double off = e.norm(C), relative = off / e.system().length();
  if (report.residual <= kLeftPerViolation * relative) return;
  throw SolveError(
      when() + e.system().row_name(e.rows(), report.worst_row) + " cannot hold together with the others (" +
          text::brief(100 * report.residual) + " % of its right side is left over); " +
          (relative > kOn ? "this stage of a step is off the constraints by " + text::brief(off) +
                                " m: take a smaller step; or two laws drive one coordinate"
                          : std::string("two laws may drive one coordinate")) +
          or_against_stops(e.system(), e.rows()) + ": look at the drives and masks of this link and its neighbours",
      {.thing = thing_of_row(e.system(), e.rows(), report.worst_row), .t = t});
}

}  // namespace lockstep
