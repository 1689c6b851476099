// Sources: J. Chung & G. M. Hulbert, J. Appl. Mech. 60 (1993) 371; on Lie groups O. Bruls, A. Cardona & M. Arnold,
// Mech. Mach. Theory 48 (2012) 121; stabilised index 2 and the start M. Arnold, O. Bruls & A. Cardona, Numer. Math. 129
// (2015) 149; states of first order K. E. Jansen, C. H. Whiting & G. M. Hulbert, CMAME 190 (2000) 305.
#include "integrators/generalized_alpha.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/support/error.h"
#include "integrators/increments.h"
#include "integrators/runge_kutta.h"

namespace lockstep {

namespace {

constexpr int kMostIterations = 25;
constexpr double kNewton = 1e-11;  // of the scene's length and the step's move: what Newton may leave of a step
constexpr double kStalled = 1e-8;  // of the same and of the first change: what shrinks no more is round-off below this
constexpr double kSlow = 0.2;      // a worse ratio of two changes asks for a fresh matrix

// out -= Jh^T lambda
void subtract_reactions(const RowTable& rows, const VecX& lambda, VecX& out) {
  for (const RowEntry& e : rows.entries) {
    const RowBlock block = rows.block(e);
    for (int i = 0; i < e.slots.n; ++i)
      for (int k = 0; k < e.m; ++k) {
        const auto r = block.J(i, k);
        const double l = lambda[e.first_row + k];
        for (int j = 0; j < 6; ++j) out[6 * e.slots[i] + j] -= l * r[j];
      }
  }
}

// Largest change of a position or turn, L times the radians; the same of a velocity.
double size_of(const VecX& d, double length) {
  double most = 0;
  for (Eigen::Index i = 0; i < d.size(); i += 6)
    most = std::max({most, d.segment<3>(i).norm(), length * d.segment<3>(i + 3).norm()});
  return d.allFinite() ? most : HUGE_VAL;
}

}  // namespace

TypeInfo GeneralizedAlpha::type_info() {
  return {"generalized_alpha",
          "implicit, order 2, fixed step, numerical damping that one number sets: stiff springs, large systems",
          {{"rho_infinity",
            Form::number,
            Unit::none,
            "0.8",
            "what a step leaves of infinitely fast modes: 0 nothing ... 1 everything",
            {}}}};
}

std::unique_ptr<Integrator> GeneralizedAlpha::make(const Params& params) {
  const double rho = params.number("rho_infinity");
  if (!(rho >= 0 && rho <= 1))
    params.refuse("rho_infinity", fmt::format("it is {}; it must lie between 0 (all damped) and 1 (nothing)", rho));
  return std::make_unique<GeneralizedAlpha>(rho);
}

GeneralizedAlpha::GeneralizedAlpha(double rho_infinity) : rho_(rho_infinity) {
  alpha_m_ = (2 * rho_ - 1) / (1 + rho_);
  alpha_f_ = rho_ / (1 + rho_);
  gamma_ = 0.5 + alpha_f_ - alpha_m_;
  beta_ = 0.25 * (gamma_ + 0.5) * (gamma_ + 0.5);
  kappa_ = (1 - alpha_f_) / (1 - alpha_m_);
}

IntegratorInfo GeneralizedAlpha::info() const { return {"generalized_alpha", 2, true, false, 3}; }

void GeneralizedAlpha::begin(Dynamics&, const State& state) {
  start_ = end_ = state;
  const Eigen::Index n = state.v.size(), n_s = state.s.size();
  for (VecX* v : {&vd_, &a_, &vd1_, &a1_, &u_, &force_, &zero_, &du_, &al_}) v->setZero(n);
  for (VecX* v : {&sd_, &as_, &sd1_, &as1_, &sd_now_}) v->setZero(n_s);
  y_.setZero(n_increments(state));
  output_.begin(state);
  h_ = 0;
}

StepReport GeneralizedAlpha::step(Dynamics& dynamics, State& state, double h) {
  copy_motion(state, start_);
  start_.z = end_.z = state.z;
  output_.forget();
  prepare(dynamics, h);
  solve(dynamics, h);
  dynamics.normalize(end_);
  StepReport report;
  report.h = h;
  report.violation = report.violation_after = dynamics.violation(end_);
  output_.set(start_, vd_, sd_, end_, vd1_, sd1_);
  if (report.violation > dynamics.options().stabilization.tolerance)
    report.violation_after = land_or_throw(dynamics, end_, "generalized_alpha", state.t, h).after;
  vd_ = vd1_, a_ = a1_, sd_ = sd1_, as_ = as1_;
  h_ = h;
  copy_motion(end_, state);
  t_ = state.t;
  return report;
}

// Consistent accelerations at the start, and wherever the state was moved since the last step (the jump of a law).
// a0 - v0' is h (alpha_m - alpha_f) v0'' + ...: it goes with the length of the step.
void GeneralizedAlpha::prepare(Dynamics& dynamics, double h) {
  if (h_ > 0 && std::abs(start_.t - t_) <= 1e-12 * std::max(std::abs(t_), h_)) {
    if (h == h_) return;
    a_ = vd_ + h / h_ * (a_ - vd_);
    as_ = sd_ + h / h_ * (as_ - sd_);
    return;
  }
  const Evaluated& values = dynamics.evaluate(start_);
  vd_ = a_ = values.a;
  lambda_ = values.lambda;
  if (start_.s.size() > 0) dynamics.system().state_rates(values, sd_);
  as_ = sd_;
  for (VecX* v : {&rows_, &C_, &Cd_, &mu_}) v->setZero(lambda_.size());
}

// Newton until theta/(1 - theta) |change| is small.
void GeneralizedAlpha::solve(Dynamics& dynamics, double h) {
  const double length = dynamics.system().length();
  vd1_ = vd_;
  sd1_ = sd_;
  u_.setZero();
  place(h);
  double before = 0, first = 0;
  bool anew = true, done = false;
  for (int i = 1; i <= kMostIterations && !done; ++i) {
    const double now = correct(dynamics, h, anew);
    place(h);
    const double theta = i > 1 ? now / before : 0.5;
    if (!std::isfinite(now) || (i > 8 && theta > 2)) fail(h, now);
    if (i == 1) first = now;
    const double scale = length + y_.head(start_.v.size()).lpNorm<Eigen::Infinity>();
    const double remains = theta < 1 ? std::min(now, theta / (1 - theta) * now) : now;
    done = remains <= kNewton * scale || (theta > 0.5 && now <= kStalled * std::max(scale, first));
    anew = theta > kSlow && i > 1;
    before = now;
  }
  if (!done) fail(h, before);
}

/// a1 and the state at the end of the step from v1', s1' and u.
void GeneralizedAlpha::place(double h) {
  const double m = 1 / (1 - alpha_m_);
  a1_ = m * ((1 - alpha_f_) * vd1_ + alpha_f_ * vd_ - alpha_m_ * a_);
  as1_ = m * ((1 - alpha_f_) * sd1_ + alpha_f_ * sd_ - alpha_m_ * as_);
  const Eigen::Index n = start_.v.size();
  y_.head(n) = h * start_.v + h * h * ((0.5 - beta_) * a_ + beta_ * a1_) + u_;
  y_.segment(n, n) = h * ((1 - gamma_) * a_ + gamma_ * a1_);
  y_.tail(start_.s.size()) = h * ((1 - gamma_) * as_ + gamma_ * as1_);
  displace(start_, y_, end_);
  end_.t = start_.t + h;
}

// Two systems with one matrix A = M + gamma h kappa D + beta h^2 kappa K (and Jh):
//   A u + Jh^T mu = 0,                               Jh u  = -C + (beta h/gamma) (Jh v + Ct)
//   A al + Jh^T l = f - M v' - Jh^T lambda - K u,    Jh al = -(Jh v + Ct)/(gamma h kappa)
double GeneralizedAlpha::correct(Dynamics& dynamics, double h, bool anew) {
  dynamics.gather(end_);
  dynamics.residuals(C_, Cd_);
  const double gh = gamma_ * h * kappa_, bh2 = beta_ * h * h * kappa_, length = dynamics.system().length();
  if (anew) {
    matrix_.gather(dynamics, lambda_);
    matrix_.factor(1, gh, bh2);
  }
  double change = 0;
  if (start_.s.size() > 0) {  // no matrix of its own: repeated until it stands
    dynamics.system().state_rates({dynamics.inputs(), vd1_, lambda_, dynamics.rows()}, sd_now_);
    const double scale = 1 + end_.s.lpNorm<Eigen::Infinity>();
    change = gh * (sd_now_ - sd1_).lpNorm<Eigen::Infinity>() / scale * length;
    sd1_ = sd_now_;
  }
  force_ = -vd1_;
  zero_.setZero();
  matrix_.add_M_times(force_, zero_);
  force_ = dynamics.force() + zero_;
  subtract_reactions(dynamics.rows(), lambda_, force_);

  rows_ = -C_ + beta_ * h / gamma_ * Cd_;
  zero_.setZero();
  matrix_.solve(zero_, rows_, du_, mu_);
  matrix_.add_K_times(du_, zero_);
  force_ -= zero_;
  rows_ = Cd_ / -gh;
  matrix_.solve(force_, rows_, al_, mu_);
  u_ += du_;
  vd1_ += al_;
  lambda_ += mu_;
  du_ += bh2 * al_;
  al_ *= gh * h;
  return std::max({change, size_of(du_, length), size_of(al_, length)});
}

void GeneralizedAlpha::fail(double h, double size) const {
  throw StepError(
      fmt::format(
          "generalized_alpha: Newton's method found no end for the step of {:.6g} s from t = {:.9g} s (the last "
          "change was {:.3g} m); take a smaller step (--step), or a method that chooses its own "
          "(--integrator radau5)",
          h, start_.t, size),
      start_.t);
}

void GeneralizedAlpha::save(Snapshot& out) const {
  out.put(h_), out.put(t_);
  for (const VecX* v : {&vd_, &a_, &sd_, &as_, &lambda_}) out.put_all(*v);
}

void GeneralizedAlpha::restore(const Snapshot& in) {
  h_ = in.get(), t_ = in.get();
  for (VecX* v : {&vd_, &a_, &sd_, &as_, &lambda_}) in.get_all(*v);
  for (VecX* v : {&rows_, &C_, &Cd_, &mu_}) v->setZero(lambda_.size());
  output_.forget();
}

}  // namespace lockstep
