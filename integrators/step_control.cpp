#include "integrators/step_control.h"

#include <algorithm>
#include <cmath>

#include "integrators/runge_kutta.h"

namespace lockstep {

namespace {

constexpr double kTiny = 1e-300;  // nothing moves and no absolute tolerance: 0/0 is 0

Quat quat_of(const VecX& q, int slot) { return Quat::from(q.segment<4>(7 * slot + 3)); }

// Largest length of the 3 numbers at `first` of every slot's 6.
double largest(const VecX& v, int first) {
  double most = 0;
  for (Eigen::Index i = first; i < v.size(); i += 6) most = std::max(most, v.segment<3>(i).squaredNorm());
  return std::sqrt(most);
}

}  // namespace

void ErrorNorm::scale(const State& y0, const StateRate& k0, double h, const State& y1) {
  const int n = static_cast<int>(y0.v.size() / 6);
  double x = 0, r = 0, v = 0, w = 0;
  for (int i = 0; i < n; ++i) {
    x = std::max(x, (y1.q.segment<3>(7 * i) - y0.q.segment<3>(7 * i)).squaredNorm());
    r = std::max(r, (conjugate(quat_of(y0.q, i)) * quat_of(y1.q, i)).vec().squaredNorm());
    v = std::max(v, (y1.v.segment<3>(6 * i) - y0.v.segment<3>(6 * i)).squaredNorm());
    w = std::max(w, (y1.v.segment<3>(6 * i + 3) - y0.v.segment<3>(6 * i + 3)).squaredNorm());
  }
  const double atol = tolerance_.atol_x + kTiny, rtol = tolerance_.relative;
  x_ = atol + rtol * std::max(std::sqrt(x), h * largest(y0.v, 0));
  r_ = atol + rtol * std::max(2 * std::sqrt(r), h * largest(y0.v, 3));
  v_ = atol + rtol * std::max(std::sqrt(v), h * largest(k0.v, 0));
  w_ = atol + rtol * std::max(std::sqrt(w), h * largest(k0.v, 3));
  const int n_s = n_s_;
  s_ = (atol + rtol * (y1.s.head(n_s) - y0.s.head(n_s)).array().abs().max(h * k0.s.head(n_s).array().abs())).matrix();
}

void ErrorNorm::scale(const State& y0, double length) {
  const double atol = tolerance_.atol_x + kTiny, rtol = tolerance_.relative;
  x_ = atol + rtol * length;
  r_ = atol + rtol;
  v_ = atol + rtol * largest(y0.v, 0);
  w_ = atol + rtol * largest(y0.v, 3);
  s_ = (atol + rtol * (1 + y0.s.head(n_s_).array().abs())).matrix();
}

// Rotation: 2 |vec(conj(e) e^)| with e^ = e - error is 2 |vec(conj(e) error)|; what lengthens e is normalised away.
double ErrorNorm::of(const StateRate& error, const State& y1) const {
  const int n = static_cast<int>(y1.v.size() / 6);
  double x = 0, r = 0;
  for (int i = 0; i < n; ++i) {
    x = std::max(x, error.q.segment<3>(7 * i).squaredNorm());
    r = std::max(r, (conjugate(quat_of(y1.q, i)) * quat_of(error.q, i)).vec().squaredNorm());
  }
  double worst =
      std::max({std::sqrt(x) / x_, 2 * std::sqrt(r) / r_, largest(error.v, 0) / v_, largest(error.v, 3) / w_});
  for (Eigen::Index i = 0; i < n_s_; ++i) worst = std::max(worst, std::abs(error.s[i]) / s_[i]);
  return error.q.allFinite() && error.v.allFinite() && error.s.allFinite() ? worst : HUGE_VAL;
}

double StepControl::accept(double error, bool after_rejection) {
  const double e = std::max(error, 1e-10);
  const double factor = std::clamp(0.9 * std::pow(e, -0.7 / p_) * std::pow(before_, 0.4 / p_), 0.2, 5.0);
  before_ = std::max(error, kFirst);
  return after_rejection ? std::min(factor, 1.0) : factor;
}

double StepControl::reject(double error) const {
  return std::isfinite(error) ? std::clamp(0.9 * std::pow(error, -1.0 / p_), 0.2, 0.9) : 0.2;
}

double guess_first_step(Dynamics& dynamics, const State& y0, int order, double largest, ErrorNorm& norm, StateRate& f0,
                        StateRate& f1, State& y1) {
  const double length = dynamics.system().length();
  norm.scale(y0, length);
  dynamics.rate(y0, f0);
  const double rtol = norm.tolerance().relative, atol = norm.tolerance().atol_x;
  const double d0 = 1 / (rtol + atol / std::max(length, 1e-6)), d1 = norm.of(f0, y0);
  const double h0 = std::min(d1 < 1e-5 ? 1e-6 : 0.01 * d0 / std::max(d1, kTiny), largest);
  copy_motion(y0, y1);
  y1.z = y0.z;
  y1.t = y0.t + h0;
  y1.q += h0 * f0.q;
  y1.v += h0 * f0.v;
  y1.s += h0 * f0.s;
  dynamics.rate(y1, f1);
  f1.q -= f0.q;
  f1.v -= f0.v;
  f1.s -= f0.s;
  const double most = std::max(d1, norm.of(f1, y0) / h0);
  const double h1 = most <= 1e-15 ? std::max(1e-6, 1e-3 * h0) : std::pow(0.01 / most, 1.0 / (order + 1));
  return std::min({100 * h0, h1, largest});
}

}  // namespace lockstep
