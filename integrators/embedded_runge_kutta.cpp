#include "integrators/embedded_runge_kutta.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/support/error.h"

namespace lockstep {

namespace {

constexpr int kFailures = 8;             // tries whose stages cannot be evaluated before the error goes on its way
constexpr double kSmallestStep = 1e-14;  // of max(|t|, step asked for)
constexpr double kViolation = 1e-3;      // of the scene's length, before projection

// Steps that only creep towards a place where nothing can be evaluated: the error there is the news, not the small
// step.
bool creeps(double t, double h) { return h < 1e-10 * std::max(std::abs(t), 1e-3); }

}  // namespace

void EmbeddedRungeKutta::begin(Dynamics& dynamics, const State& state) {
  dynamics_ = &dynamics;
  stages_.begin(scheme_.tableau, state);
  start_ = end_ = landed_ = state;
  error_ = sized_like(state);
  poly_.resize(static_cast<std::size_t>(3 + scheme_.n_dense));
  for (StateRate& p : poly_) p = sized_like(state);
  norm_.set_states(dynamics.system().n_steering_states());
  norm_.scale(state, 1.0);
  control_.begin();
  h_ = 0;
  dense_ready_ = false;
}

StepReport EmbeddedRungeKutta::step(Dynamics& dynamics, State& state, double h) {
  StepReport report;
  const double smallest = kSmallestStep * std::max(std::abs(state.t), h);
  int failures = 0;
  copy_motion(state, start_);
  start_.z = end_.z = landed_.z = state.z;
  h_ = 0;
  dense_ready_ = false;
  stages_.evaluate(dynamics, start_, h, 0, 1);  // depends on no h: rejected tries keep it
  for (;; ++report.rejected) {
    double factor = 0.5;
    try {
      const Try t = attempt(dynamics, h);
      if (t.landed && (fixed_ || t.error <= 1)) {
        report.h = h_ = h;
        report.error = t.error;
        report.violation = t.violation;
        report.violation_after = t.violation_after;
        if (!fixed_) report.h_next = h * control_.accept(t.error, report.rejected > 0);
        break;
      }
      factor = shorter(t);
    } catch (const NonFiniteError&) {
      if (fixed_ || ++failures > kFailures || creeps(state.t, 0.5 * h)) throw;
    } catch (const SolveError&) {
      if (fixed_ || ++failures > kFailures || creeps(state.t, 0.5 * h)) throw;
    }
    h *= factor;
    if (h < smallest || state.t + h == state.t)
      throw StepError(
          fmt::format("{}: the step shrank to {:.3g} s at t = {:.9g} s after {} rejections; take another method "
                      "(--integrator), a wider tolerance, or look for a singular place (lockstep check)",
                      scheme_.name, h, state.t, report.rejected + 1),
          state.t);
  }
  copy_motion(landed_, state);
  return report;
}

EmbeddedRungeKutta::Try EmbeddedRungeKutta::attempt(Dynamics& dynamics, double h) {
  Try t;
  stages_.evaluate(dynamics, start_, h, 1, scheme_.tableau.n_stages);
  stages_.combine(start_, h, scheme_.tableau.b, scheme_.tableau.n_stages, end_);
  t.error = fixed_ ? 0 : estimate(h);
  if (t.error > 1) return t;
  copy_motion(end_, landed_);
  if (fixed_) {
    const ProjectReport report = land_or_throw(dynamics, landed_, scheme_.name, start_.t, h);
    t.violation = report.before, t.violation_after = report.after, t.landed = true;
    return t;
  }
  const bool projected = dynamics.options().stabilization.kind == Stabilization::Kind::project;
  const ProjectReport report = land(dynamics, landed_);
  t.violation = report.before, t.violation_after = report.after;
  t.landed = !projected || (report.converged && report.before <= kViolation * dynamics.system().length());
  return t;
}

// dop853: e5^2 / sqrt(e5^2 + 0.01 e3^2), Hairer, Norsett & Wanner 1993, II.10.
double EmbeddedRungeKutta::estimate(double h) {
  const int n = scheme_.tableau.n_stages;
  norm_.scale(start_, stages_.k(0), h, end_);
  stages_.sum(h, scheme_.error, n, error_);
  const double e5 = norm_.of(error_, end_);
  if (!scheme_.second || e5 == 0) return e5;
  stages_.sum(h, scheme_.second, n, error_);
  const double e3 = norm_.of(error_, end_);
  return std::isfinite(e5) && std::isfinite(e3) ? e5 * (e5 / std::hypot(e5, 0.1 * e3)) : HUGE_VAL;
}

double EmbeddedRungeKutta::shorter(const Try& t) const { return t.error > 1 ? control_.reject(t.error) : 0.5; }

bool EmbeddedRungeKutta::dense(double t, State& out) const {
  if (!dynamics_) return false;
  copy_motion(start_, out);
  out.z = start_.z;
  out.modes = start_.modes;
  if (h_ == 0) return t == start_.t;
  if (!dense_ready_) prepare_dense();
  const double theta = (t - start_.t) / h_;
  double factor = theta;  // theta, theta (1 - theta), theta^2 (1 - theta), ...
  for (std::size_t i = 0; i < poly_.size(); ++i) {
    out.q += factor * poly_[i].q;
    out.v += factor * poly_[i].v;
    out.s += factor * poly_[i].s;
    factor *= i % 2 == 0 ? 1 - theta : theta;
  }
  out.t = t;
  dynamics_->normalize(out);
  return true;
}

// y(theta) = y0 + theta (p0 + (1 - theta)(p1 + theta (p2 + (1 - theta)(p3 + ...)))),
// p0 = y1 - y0, p1 = h k(t0) - p0, p2 = p0 - h k(t1) - p1, p3 ... = h sum d_i k_i
void EmbeddedRungeKutta::prepare_dense() const {
  const Tableau& tableau = scheme_.tableau;
  stages_.evaluate(*dynamics_, start_, h_, tableau.n_stages, tableau.n_all);
  const auto each = [&](auto part, auto state_part) {
    VecX &p0 = poly_[0].*part, &p1 = poly_[1].*part, &p2 = poly_[2].*part;
    p0 = end_.*state_part - start_.*state_part;
    p1 = h_ * (stages_.k(0).*part) - p0;
    p2 = p0 - h_ * (stages_.k(scheme_.end_stage).*part) - p1;
  };
  each(&StateRate::q, &State::q);
  each(&StateRate::v, &State::v);
  each(&StateRate::s, &State::s);
  for (int i = 0; i < scheme_.n_dense; ++i)
    stages_.sum(h_, scheme_.d + i * tableau.n_all, tableau.n_all, poly_[static_cast<std::size_t>(3 + i)]);
  dense_ready_ = true;
}

double EmbeddedRungeKutta::first_step(Dynamics& dynamics, const State& state, double largest) {
  if (fixed_) return 0;
  h_ = 0;  // its scratch is the dense output's
  dense_ready_ = false;
  return guess_first_step(dynamics, state, scheme_.tableau.order, largest, norm_, poly_[0], poly_[1], end_);
}

}  // namespace lockstep
