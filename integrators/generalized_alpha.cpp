// SPDX-License-Identifier: BSD-3-Clause
// Sources: J. Chung & G. M. Hulbert, J. Appl. Mech. 60 (1993) 371; on Lie groups O. Bruls, A. Cardona & M. Arnold,
// Mech. Mach. Theory 48 (2012) 121; stabilised index 2 and the start M. Arnold, O. Bruls & A. Cardona, Numer. Math. 129
// (2015) 149; states of first order K. E. Jansen, C. H. Whiting & G. M. Hulbert, CMAME 190 (2000) 305.
#include <lockstep/integrators.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/dynamics/evaluate/speed_of.h"
#include "framework/foundation/math/limits.h"
#include "framework/mechanism/rows/loads.h"

namespace lockstep {

namespace {

constexpr int kMostIterations = 25;
constexpr double kNewton = 1e-11;  // relative to the scene's length and the step's move: the end of Newton's iteration
constexpr double kStalled =
    1e-8;  // relative to the same and to the first change: less that no longer shrinks is round-off
constexpr int kMostReactions = 30;   // solutions with friction at the new multipliers
constexpr double kReactions = 1e-6;  // relative to its first change: the end of these solutions; Newton does the rest
constexpr double kSlow = 0.2;        // a larger ratio of two changes needs a fresh matrix

// Largest change of a position or rotation, the latter times the length; likewise of velocities.
double largest_change(const VecX& d, double length) { return d.allFinite() ? length * speed_of(d, length) : HUGE_VAL; }

}  // namespace

TypeInfo GeneralizedAlpha::type_info() {
  return {"generalized_alpha",
          "implicit, order 2, fixed step, numerical damping set by one number: stiff springs, large systems",
          {{"rho_infinity",
            Form::number,
            Unit::none,
            0.8,
            "share of infinitely fast modes that remains after a step: 0 (none) to 1 (all)",
            {}},
           {"adaptive", Form::boolean, Unit::none, false, "choose the steps by the tolerance", {}}}};
}

std::unique_ptr<Integrator> GeneralizedAlpha::make(const Params& params) {
  const double rho = params.number("rho_infinity");
  if (!(rho >= 0 && rho <= 1))
    params.refuse("rho_infinity", fmt::format("it is {}; it must be between 0 (full damping) and 1 (none)", rho));
  return std::make_unique<GeneralizedAlpha>(rho, params.boolean("adaptive"));
}

GeneralizedAlpha::GeneralizedAlpha(double rho_infinity, bool adaptive)
    : AdaptiveStepper(2, adaptive ? std::make_unique<PiControl>(3) : nullptr), rho_(rho_infinity) {
  alpha_m_ = (2 * rho_ - 1) / (1 + rho_);
  alpha_f_ = rho_ / (1 + rho_);
  gamma_ = 0.5 + alpha_f_ - alpha_m_;
  beta_ = 0.25 * (gamma_ + 0.5) * (gamma_ + 0.5);
  kappa_ = (1 - alpha_f_) / (1 - alpha_m_);
}

IntegratorInfo GeneralizedAlpha::info() const { return {"generalized_alpha", 2, true, !fixed(), 3}; }

void GeneralizedAlpha::begin(Dynamics& dynamics, const State& state) {
  AdaptiveStepper::begin(dynamics, state);
  const Eigen::Index n = state.v.size(), n_s = state.s.size();
  for (VecX* v : {&vd_, &a_, &vd1_, &a1_, &a0_, &bend_, &u_, &force_, &zero_, &du_, &al_, &friction_, &friction1_})
    v->setZero(n);
  for (VecX* v : {&sd_, &as_, &sd1_, &as1_, &as0_, &sd_now_}) v->setZero(n_s);
  y_.setZero(n_increments(state));
  size_like(state, rate_), size_like(state, difference_);
  output_.begin(state);
  matrix_.set_residual(kReactions);  // Newton does the rest
  h_ = 0;
}

// Consistent accelerations at the start, and if the state was moved since the last step (the jump of a law).
double GeneralizedAlpha::start_step(Dynamics& dynamics, double h) {
  output_.forget();
  if (h_ > 0 && std::abs(start_.t - t_) <= kRoundOff * std::max(std::abs(t_), h_)) return h;
  const Evaluated& values = dynamics.evaluate(start_);
  vd_ = a_ = values.a;
  lambda_ = values.lambda;
  if (start_.s.size() > 0) passes::state_rates(dynamics.system(), values, sd_);
  as_ = sd_;
  h_ = 0;
  for (VecX* v : {&rows_, &C_, &Cd_, &mu_}) v->setZero(lambda_.size());
  return h;
}

Attempt GeneralizedAlpha::attempt(Dynamics& dynamics, double h) {
  Attempt made;
  const bool found = solve(dynamics, h);
  if (!found && fixed())
    newton_failed(h, "another method (--integrator radau5), or find a singular configuration (lockstep check)");
  if (found && !fixed()) made.error = estimate(h);
  made.accepted = found && made.error <= 1;
  return made;
}

// The end is already on the constraints, up to the residual of Newton's method.
ProjectReport GeneralizedAlpha::project_end(Dynamics& dynamics, State& y) {
  ProjectReport report;
  dynamics.normalize(y);
  report.before = report.after = dynamics.violation(y);
  if (report.before <= dynamics.options().stabilization.tolerance) return report;
  const double before = report.before;
  report = AdaptiveStepper::project_end(dynamics, y);
  report.before = before;
  return report;
}

void GeneralizedAlpha::finish_step(Dynamics& dynamics, StepReport& report) {
  dynamics.normalize(end_);
  output_.set(start_, vd_, sd_, end_, vd1_, sd1_);
  h_ = report.h;
  t_ = landed_.t;
  bend_ = (vd1_ - vd_) / h_;
  vd_ = vd1_, a_ = a1_, sd_ = sd1_, as_ = as1_, lambda_ = lambda1_;
}

// Newton until theta/(1 - theta) |change| is small. a0 - v0' is h (alpha_m - alpha_f) v0'' + ...: it scales with h.
bool GeneralizedAlpha::solve(Dynamics& dynamics, double h) {
  const double length = dynamics.system().length(), stretch = h_ > 0 ? h / h_ : 1;
  a0_ = vd_ + stretch * (a_ - vd_);
  as0_ = sd_ + stretch * (as_ - sd_);
  vd1_ = vd_;
  sd1_ = sd_;
  lambda1_ = lambda_;
  u_.setZero();
  update_end(h);
  double before = 0, first = 0;
  bool anew = true;
  for (int i = 1; i <= kMostIterations; ++i) {
    const double now = correct(dynamics, h, anew);
    update_end(h);
    const double theta = i > 1 ? now / before : 0.5;
    if (!std::isfinite(now) || (i > 8 && theta > 2)) return false;
    if (i == 1) first = now;
    const double scale = length + y_.head(start_.v.size()).lpNorm<Eigen::Infinity>();
    const double remains = theta < 1 ? std::min(now, theta / (1 - theta) * now) : now;
    if (remains <= kNewton * scale || (theta > 0.5 && now <= kStalled * std::max(scale, first))) return true;
    anew = theta > kSlow && i > 1;
    before = now;
  }
  return false;
}

// With d = alpha_m - alpha_f: positions (d/2 + beta - 1/6) h^3 d^3q/dt^3, velocities (1/12 - d^2/2) h^3 d^3v/dt^3, from
// the differences of v' at the ends of this step and of the one before.
double GeneralizedAlpha::estimate(double h) {
  const Eigen::Index n = start_.v.size();
  const double d = alpha_m_ - alpha_f_, c_q = 0.5 * d + beta_ - 1.0 / 6, c_v = 1.0 / 12 - 0.5 * d * d;
  rate_.v = vd_;
  rate_.s = sd_;
  norm_.scale(start_, rate_, h, end_);
  du_ = c_q * h * h * (vd1_ - vd_);
  filter(y_.head(n));
  if (h_ > 0)
    du_ = (2 * c_v * h * h / (h + h_)) * ((vd1_ - vd_) - h * bend_);
  else
    du_ /= h;
  filter(y_.segment(n, n));
  y_.tail(start_.s.size()) = c_q * h * (sd1_ - sd_);
  as_difference(y_, start_, difference_);
  return norm_.of(difference_, start_);
}

// out = A^-1 M du on the constraints: removes fast modes, which the step does not resolve, from the error.
void GeneralizedAlpha::filter(Eigen::Ref<VecX> out) {
  force_.setZero();
  matrix_.add_M_times(du_, force_);
  rows_.setZero();
  matrix_.solve(force_, rows_, al_, mu_);
  out = al_;
}

/// a1 and the state at the end of the step from v1', s1' and u.
void GeneralizedAlpha::update_end(double h) {
  const double m = 1 / (1 - alpha_m_);
  a1_ = m * ((1 - alpha_f_) * vd1_ + alpha_f_ * vd_ - alpha_m_ * a0_);
  as1_ = m * ((1 - alpha_f_) * sd1_ + alpha_f_ * sd_ - alpha_m_ * as0_);
  const Eigen::Index n = start_.v.size();
  y_.head(n) = h * start_.v + h * h * ((0.5 - beta_) * a0_ + beta_ * a1_) + u_;
  y_.segment(n, n) = h * ((1 - gamma_) * a0_ + gamma_ * a1_);
  y_.tail(start_.s.size()) = h * ((1 - gamma_) * as0_ + gamma_ * as1_);
  displace_state(start_, y_, end_);
  end_.t = start_.t + h;
}

// Two systems with one matrix A = M + gamma h kappa D + beta h^2 kappa K (and Jh):
//   A u + Jh^T mu = 0,                               Jh u  = -C + (beta h/gamma) (Jh v + Ct)
//   A al + Jh^T l = f - M v' - Jh^T lambda - K u,    Jh al = -(Jh v + Ct)/(gamma h kappa)
double GeneralizedAlpha::correct(Dynamics& dynamics, double h, bool anew) {
  const Evaluation& e = dynamics.gather(end_);
  e.residuals(C_, Cd_);
  ++dynamics.work().evaluations;
  const double gh = gamma_ * h * kappa_, bh2 = beta_ * h * h * kappa_, length = dynamics.system().length();
  if (anew) {
    matrix_.gather(e, lambda1_);
    matrix_.factor(1, gh, bh2);
    ++dynamics.work().factors;
  }
  double change = 0;
  if (start_.s.size() > 0) {  // not in the matrix: repeated until it settles
    passes::state_rates(dynamics.system(), {e.inputs(), vd1_, lambda1_, e.rows()}, sd_now_);
    const int n = dynamics.system().n_error_controlled_states();  // the others follow the motion
    const double scale = 1 + end_.s.head(n).lpNorm<Eigen::Infinity>();
    change = gh * (sd_now_ - sd1_).head(n).lpNorm<Eigen::Infinity>() / scale * length;
    sd1_ = sd_now_;
  }
  force_ = -vd1_;
  zero_.setZero();
  matrix_.add_M_times(force_, zero_);
  force_ = e.force() + zero_;
  subtract_reactions(e.rows(), lambda1_, force_);
  if (!e.reacting().empty()) e.react(lambda1_, force_);

  rows_ = -C_ + beta_ * h / gamma_ * Cd_;
  zero_.setZero();
  matrix_.solve(zero_, rows_, du_, mu_);
  matrix_.add_K_times(du_, zero_);
  force_ -= zero_;
  rows_ = Cd_ / -gh;
  matrix_.solve(force_, rows_, al_, mu_);
  if (!e.reacting().empty()) settle_reactions(e);
  u_ += du_;
  vd1_ += al_;
  lambda1_ += mu_;
  du_ += bh2 * al_;
  al_ *= gh * h;
  return std::max({change, largest_change(du_, length), largest_change(al_, length)});
}

// The dependence of friction on the multipliers is not in the matrix: al and mu are solved again with the friction at
// lambda1 + mu, until that settles.
void GeneralizedAlpha::settle_reactions(const Evaluation& e) {
  friction_.setZero();
  e.react(lambda1_, friction_);
  force_ -= friction_;  // the part that stays fixed
  double first = 0;
  for (int i = 1; i <= kMostReactions; ++i) {
    lambda_try_ = lambda1_ + mu_;
    friction1_.setZero();
    e.react(lambda_try_, friction1_);
    friction_ = friction1_ - friction_;
    const double change = largest_change(friction_, 1 / e.system().length());
    if (i == 1) first = change;
    if (change <= kReactions * first) return;
    friction_.swap(friction1_);
    zero_ = force_ + friction_;
    matrix_.solve(zero_, rows_, al_, mu_);
  }
}

void GeneralizedAlpha::save(Snapshot& out) const {
  AdaptiveStepper::save(out);
  out.put(h_), out.put(t_);
  for (const VecX* v : {&vd_, &a_, &sd_, &as_, &bend_, &lambda_}) out.put_all(*v);
}

void GeneralizedAlpha::restore(SnapshotReader& in) {
  AdaptiveStepper::restore(in);
  h_ = in.get(), t_ = in.get();
  for (VecX* v : {&vd_, &a_, &sd_, &as_, &bend_}) {
    const Eigen::Index own = v->size();  // by begin()
    in.get_all(*v);
    if (v->size() != own) throw ModelError("generalized_alpha: the saved history belongs to another mechanism");
  }
  in.get_all(lambda_);
  for (VecX* v : {&rows_, &C_, &Cd_, &mu_}) v->setZero(lambda_.size());
  output_.forget();
}

}  // namespace lockstep
