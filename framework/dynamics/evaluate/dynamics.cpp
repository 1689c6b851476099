#include "framework/dynamics/evaluate/dynamics.h"

#include <algorithm>
#include <cmath>

#include "framework/dynamics/evaluate/advice.h"
#include "framework/dynamics/evaluate/matrix.h"
#include "framework/foundation/support/error.h"
#include "framework/foundation/support/text.h"

namespace lockstep {
Dynamics::Dynamics(System& system, std::unique_ptr<LinearSolver> solver, DynamicsOptions options)
    : system_(system), solver_(std::move(solver)), options_(options) {
  if (!solver_) throw ModelError("dynamics: no solver was given; make one, for instance SparseSolver");
  const Stabilization& s = options_.stabilization;
  if (!(s.alpha >= 0) || !(s.beta >= 0) || !(s.tolerance > 0))
    throw ModelError("stabilisation: alpha " + brief(s.alpha) + ", beta " + brief(s.beta) + ", tolerance " +
                     brief(s.tolerance) + "; the rates must not be negative and the tolerance must be above zero");
  system_.setup();
  values_ = std::make_unique<Evaluated>(Evaluated{in_, a_, lambda_, rows_});
}
Dynamics::~Dynamics() = default;

/// Sizes and the symbolic work, when the description or the set of active links changed.
void Dynamics::prepare(const State& state) {
  if (laid_out_ && system_.ready() && system_.revision() == revision_ && state.modes == modes_) {
    system_.check_size(state);
    return;
  }
  system_.setup();
  system_.check_size(state);
  revision_ = system_.revision();
  if (!matrix_) matrix_ = std::make_unique<Matrix>(system_, options_.formulation);
  modes_ = state.modes;
  system_.lay_out(modes_, rows_);
  matrix_->lay_out(rows_, solver_->reads_rows());
  factor_ = solver_->analyse(matrix_->kkt().pattern);
  factored_ = false;
  const int n = 6 * system_.n_slots();
  f_.setZero(n), a_.setZero(n), zero_.setZero(n), d_.setZero(n);
  reacting_.clear();
  for (const auto& force : system_.forces())
    if (!force->reads().empty()) reacting_.push_back(force.get());
  if (!reacting_.empty())
    for (VecX* v : {&added_, &added_before_, &change_, &change_before_, &loaded_}) v->setZero(n);
  c_.setZero(rows_.n_rows), C_.setZero(rows_.n_rows), Cd_.setZero(rows_.n_rows), lambda_.setZero(rows_.n_rows);
  solved_f_.setZero(matrix_->n()), solved_a_.setZero(matrix_->n());
  solved_c_.setZero(matrix_->m()), solved_lambda_.setZero(matrix_->m());
  laid_out_ = true;
}

/// The first pass: what links and forces see of the state.
void Dynamics::see(const State& state) {
  prepare(state);
  system_.motions(state, motions_);
  in_.t = state.t;
  in_.motions = motions_;
  in_.s = {state.s.data(), static_cast<std::size_t>(state.s.size())};
  in_.z = {state.z.data(), static_cast<std::size_t>(state.z.size())};
}

const Inputs& Dynamics::look(const State& state) {
  see(state);
  return in_;
}

void Dynamics::gather(const State& state) {
  gather_unchecked(state);
  check_gathered(state);
}

void Dynamics::gather_unchecked(const State& state) {
  see(state);
  system_.gather_rows(in_, rows_);
  system_.gather_forces(in_, f_);
  factored_ = false;
}

void Dynamics::refactor() {
  matrix_->update(rows_, motions_);
  factor_->compute(matrix_->kkt());
  factored_ = true;
  ++work_.factors;
}

const SolveReport& Dynamics::solve(const VecX& f, const VecX& c, VecX& a, VecX& lambda) {
  if (!factored_) refactor();
  return solve_loaded(f, c, false, a, lambda);
}

const SolveReport& Dynamics::solve_loaded(const VecX& f, const VecX& c, bool moving, VecX& a, VecX& lambda) {
  report_complete_ = false;
  if (matrix_->direct()) {
    solve_report_ = factor_->solve(matrix_->kkt(), f, c, a, lambda);
    work_.corrections += solve_report_.corrections;
    return solve_report_;
  }
  matrix_->load(f, c, motions_, moving, solved_f_, solved_c_);
  solve_report_ = factor_->solve(matrix_->kkt(), solved_f_, solved_c_, solved_a_, solved_lambda_);
  work_.corrections += solve_report_.corrections;
  a.resize(6 * system_.n_slots());
  matrix_->unload(solved_a_, solved_lambda_, motions_, rows_.n_rows, a, lambda);
  return solve_report_;
}

const SolveReport& Dynamics::last_solve() const {
  if (!report_complete_) factor_->complete(solve_report_);
  report_complete_ = true;
  return solve_report_;
}

const Evaluated& Dynamics::evaluate(const State& state) {
  gather_unchecked(state);
  refactor();
  // c = Qhat + Qs; Qs = -2 alpha Cd - beta^2 C (2.15)
  const bool baumgarte = options_.stabilization.kind == Stabilization::Kind::baumgarte;
  if (baumgarte) residuals(C_, Cd_);
  for (const RowEntry& e : rows_.entries) {
    const RowBlock block = rows_.block(e);
    for (int k = 0; k < e.m; ++k) c_[e.first_row + k] = block.Qhat(k);
  }
  if (baumgarte) {
    const double alpha = options_.stabilization.alpha, beta = options_.stabilization.beta;
    c_ -= 2.0 * alpha * Cd_ + beta * beta * C_;
  }
  solve_loaded(f_, c_, true, a_, lambda_);
  if (!reacting_.empty()) find_reactions(state);
  ++work_.evaluations;
  check_solved(state);
  return *values_;
}

void Dynamics::rate(const State& state, StateRate& out) {
  evaluate(state);
  const int n = system_.n_slots();
  out.q.resize(7 * n);
  out.v.resize(6 * n);
  out.s.resize(state.s.size());
  for (int k = 0; k < n; ++k) {  // (1.8); of the raw quaternion, so that its length is kept by the exact flow
    const Quat q = Quat::from(state.q.segment<4>(7 * k + 3));
    out.q.segment<3>(7 * k) = state.v.segment<3>(6 * k);
    out.q.segment<4>(7 * k + 3) = lockstep::rate(q, Vec3(state.v.segment<3>(6 * k + 3))).coefficients();
  }
  out.v = a_;
  if (state.s.size() > 0) {
    system_.state_rates(*values_, out.s);
    if (!out.s.allFinite()) blame_rates(state, out.s);
  }
}

void Dynamics::residuals(VecX& C, VecX& Cd) const {
  for (const RowEntry& e : rows_.entries) {
    const RowBlock block = rows_.block(e);
    for (int k = 0; k < e.m; ++k) {
      double cd = block.Ct(k);
      for (int i = 0; i < e.slots.n; ++i) {
        const auto r = block.J(i, k);
        const Motion& O = in_.slot(e.slots[i]);
        cd += r[0] * O.v[0] + r[1] * O.v[1] + r[2] * O.v[2] + r[3] * O.w[0] + r[4] * O.w[1] + r[5] * O.w[2];
      }
      C[e.first_row + k] = block.C(k);
      Cd[e.first_row + k] = cd;
    }
  }
}

double Dynamics::norm(const VecX& c) const {
  double worst = 0;
  const double L = system_.length();
  for (const RowEntry& e : rows_.entries)
    for (int k = 0; k < e.m; ++k) {
      const RowKind kind = e.kind[static_cast<std::size_t>(k)];
      const double scale = kind == RowKind::translation ? 1.0 : kind == RowKind::rotation ? 2.0 * L : L;
      const double x = scale * std::abs(c[e.first_row + k]);
      worst = x > worst || std::isnan(x) ? x : worst;
    }
  return worst;
}

double Dynamics::violation(const State& state) {
  gather(state);
  residuals(C_, Cd_);
  return norm(C_);
}

double Dynamics::violation_v(const State& state) {
  gather(state);
  residuals(C_, Cd_);
  return norm(Cd_);
}

void Dynamics::move(State& state, const VecX& d) const { advance(state, 1.0, d); }

void Dynamics::advance(State& state, double h, const VecX& v) const {
  for (int k = 0; k < system_.n_slots(); ++k) {
    state.q.segment<3>(7 * k) += h * v.segment<3>(6 * k);
    const Quat q = Quat::from(state.q.segment<4>(7 * k + 3)) * exponential(Vec3(h * v.segment<3>(6 * k + 3)));
    state.q.segment<4>(7 * k + 3) = q.coefficients();
  }
}

void Dynamics::normalize(State& state) const {
  for (int k = 0; k < system_.n_slots(); ++k) state.q.segment<4>(7 * k + 3).normalize();
}

void Dynamics::accept(State& state) {
  if (state.z.size() == 0) return;
  see(state);
  system_.accept(in_, state);
}

void Dynamics::check_solved(const State& state) const {
  const auto when = [&] { return "t = " + number(state.t) + " s: "; };
  if (!a_.allFinite() || !lambda_.allFinite()) {
    check_gathered(state);  // names who made it
    throw NonFiniteError(when() + "the accelerations are not finite although every row and force is; solver '" +
                             std::string(solver_->name()) +
                             "' failed on this pose (try `dense`), or the motion has blown up: " + kShorter,
                         state.t);
  }
  if (solve_report_.contradictory)
    throw SolveError(when() + system_.row_name(rows_, solve_report_.worst_row) +
                     " cannot hold together with the others (" + brief(100 * solve_report_.residual) +
                     " % of its right side is left over); two laws may drive one coordinate: "
                     "look at the drives and masks of this link and its neighbours");
}

}  // namespace lockstep
