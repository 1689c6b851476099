// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/stepping.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "framework/dynamics/integrate/body_error.h"

namespace lockstep {

namespace {

double squared(const double* v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }
double squared_difference(const double* a, const double* b) {
  const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return x * x + y * y + z * z;
}
// |vec(conj(a) b)|^2.
double squared_turn(const double* a, const double* b) {
  const double x = a[0] * b[1] - a[1] * b[0] - a[2] * b[3] + a[3] * b[2];
  const double y = a[0] * b[2] - a[2] * b[0] - a[3] * b[1] + a[1] * b[3];
  const double z = a[0] * b[3] - a[3] * b[0] - a[1] * b[2] + a[2] * b[1];
  return x * x + y * y + z * z;
}

// Largest squared norms of the first and of the last three of every slot's 6. `sum` adds all of them and is not finite
// when any of them is not.
struct SlotNorms {
  double linear = 0, angular = 0, sum = 0;
  explicit SlotNorms(const VecX& v) {
    const double* p = v.data();
    for (const double* end = p + v.size(); p != end; p += 6) {
      const double x = squared(p), w = squared(p + 3);
      linear = std::max(linear, x), angular = std::max(angular, w);
      sum += x + w;
    }
  }
};

// Over a step of h from y0, with the rates k0 there, to y1; not less than the rates give.
Change change_of_slots(const State& y0, const StateRate& k0, double h, const State& y1) {
  const Eigen::Index n = y0.v.size() / 6;
  const double *q0 = y0.q.data(), *q1 = y1.q.data(), *v0 = y0.v.data(), *v1 = y1.v.data();
  Change c;
  for (Eigen::Index i = 0; i < n; ++i, q0 += 7, q1 += 7, v0 += 6, v1 += 6)
    c.take(squared_difference(q1, q0), 4 * squared_turn(q0 + 3, q1 + 3), squared_difference(v1, v0),
           squared_difference(v1 + 3, v0 + 3));
  const SlotNorms speed(y0.v), acceleration(k0.v);
  const double h2 = h * h;
  c.take(h2 * speed.linear, h2 * speed.angular, h2 * acceleration.linear, h2 * acceleration.angular);
  return c;
}

// The same from the slots' motions at both ends.
Change change_of_motions(std::span<const Motion> a, const StateRate& k0, double h, std::span<const Motion> b) {
  Change c;
  const double h2 = h * h;
  for (std::size_t k = 1; k < a.size(); ++k) {
    const Motion &A = a[k], &B = b[k];
    c.take((B.x - A.x).squaredNorm(), 4 * (conjugate(A.e) * B.e).vec().squaredNorm(), (B.v - A.v).squaredNorm(),
           (B.w - A.w).squaredNorm());
    c.take(h2 * A.v.squaredNorm(), h2 * A.w.squaredNorm(), 0, 0);
  }
  c.take(0, 0, h2 * k0.largest_a * k0.largest_a, h2 * k0.largest_alpha * k0.largest_alpha);
  return c;
}

}  // namespace

bool ErrorNorm::Moving::are_of(const State& y) const {
  return t == y.t && coordinates == y.coordinates && q == y.q && v == y.v && s == y.s.head(s.size());
}

void ErrorNorm::Moving::at(const State& y, int n_s) {
  t = y.t, q = y.q, v = y.v, s = y.s.head(n_s), coordinates = y.coordinates;
  motions.resize(y.coordinates->n_slots() + 1);  // the ground, at rest, is never written
  y.coordinates->motions(y, motions);
}

void ErrorNorm::scale(const State& y0, const StateRate& k0, double h, const State& y1) {
  if (y0.coordinates) {
    if (now_.are_of(y0)) std::swap(before_, now_);  // the end of the step before
    if (!before_.are_of(y0)) before_.at(y0, n_s_);  // else the step is attempted again
    now_.at(y1, n_s_);
  }
  weights_ = weights_of(tolerance_, y0.coordinates ? change_of_motions(before_.motions, k0, h, now_.motions)
                                                   : change_of_slots(y0, k0, h, y1));
  const double atol = tolerance_.atol_x + kTiny, rtol = tolerance_.relative;
  s_.resize(n_s_);
  for (Eigen::Index i = 0; i < n_s_; ++i)
    s_[i] = atol + rtol * std::max(std::abs(y1.s[i] - y0.s[i]), h * std::abs(k0.s[i]));
}

void ErrorNorm::scale(const State& y0, double length) {
  double v = 0, w = 0;
  if (y0.coordinates) {
    now_.at(y0, n_s_);
    for (const Motion& O : now_.motions) v = std::max(v, O.v.squaredNorm()), w = std::max(w, O.w.squaredNorm());
  } else {
    const SlotNorms speed(y0.v);
    v = speed.linear, w = speed.angular;
  }
  const double atol = tolerance_.atol_x + kTiny, rtol = tolerance_.relative;
  weights_ = {atol + rtol * length, atol + rtol, atol + rtol * std::sqrt(v), atol + rtol * std::sqrt(w)};
  s_ = (atol + rtol * (1 + y0.s.head(n_s_).array().abs())).matrix();
}

// Rotation: 2 |vec(conj(e) e^)| with e^ = e - error is 2 |vec(conj(e) error)|; a change of |e| is normalised away.
double ErrorNorm::of(const StateRate& error, const State& y1) {
  Change c;
  double sum = 0;  // not finite when any part of the error is not
  if (y1.coordinates) {
    y1.coordinates->variations(y1, now_.motions, error, dx_, dv_);
    for (Eigen::Index k = 0; k < dx_.size(); k += 6) {
      const Motion& O = now_.motions[k / 6 + 1];
      const Vec3 phi = dx_.segment<3>(k + 3), w = dv_.segment<3>(k + 3) - cross(phi, Vec3(O.A * O.w));  // slot axes
      const double x = dx_.segment<3>(k).squaredNorm(), r = phi.squaredNorm(), v = dv_.segment<3>(k).squaredNorm();
      c.take(x, r, v, w.squaredNorm());
      sum += x + r + v + w.squaredNorm();
    }
    for (Eigen::Index k = 0; k < error.followed.size();
         k += 12) {  // what laws move has an error as if it were integrated
      const auto part = [&](Eigen::Index at) { return squared(error.followed.data() + k + at); };
      c.take(part(0), part(3), part(6), part(9));
      sum += part(0) + part(3) + part(6) + part(9);
    }
  } else {
    const Eigen::Index n = y1.v.size() / 6;
    const double *d = error.q.data(), *q = y1.q.data();
    for (Eigen::Index i = 0; i < n; ++i, d += 7, q += 7) {
      const double x = squared(d), r = squared_turn(q + 3, d + 3);
      c.take(x, 4 * r, 0, 0);
      sum += x + r;
    }
    const SlotNorms v(error.v);
    c.take(0, 0, v.linear, v.angular);
    sum += v.sum;
  }
  double worst = in_tolerances(c, weights_);
  for (Eigen::Index i = 0; i < n_s_; ++i) worst = std::max(worst, std::abs(error.s[i]) / s_[i]);
  for (Eigen::Index i = 0; i < error.s.size(); ++i) sum += std::abs(error.s[i]);
  return std::isfinite(sum) ? worst : HUGE_VAL;
}

StepControl::~StepControl() = default;

double PiControl::accept(double, double error, int, bool after_rejection) {
  const double e = std::max(error, 1e-10);
  const double factor = std::clamp(0.9 * std::pow(e, -0.7 / p_) * std::pow(before_, 0.4 / p_), 0.2, 5.0);
  before_ = std::max(error, kFirst);
  return after_rejection ? std::min(factor, 1.0) : factor;
}

double PiControl::reject(double error, int) const {
  return std::isfinite(error) ? std::clamp(0.9 * std::pow(error, -1.0 / p_), 0.2, 0.9) : 0.2;
}

bool step_vanished(double t, double h, double asked) { return h < 1e-14 * std::max(std::abs(t), asked) || t + h == t; }

bool step_stalled(double t, double h) { return h < 1e-10 * std::max(std::abs(t), 1e-3); }

bool end_is_near(bool converged, double violation, double length) { return converged && violation <= 1e-3 * length; }

bool end_is_near(const Dynamics& dynamics, const ProjectReport& end, bool fixed) {
  if (dynamics.options().stabilization.kind != Stabilization::Kind::project) return true;
  return fixed ? end.converged : end_is_near(end.converged, end.before, dynamics.system().length());
}

double guess_first_step(Dynamics& dynamics, const State& y0, int order, double largest, ErrorNorm& norm, StateRate& f0,
                        StateRate& f1, State& y1) {
  dynamics.system().check_size(y0);
  const double length = dynamics.system().length();
  norm.scale(y0, length);
  dynamics.rates(y0, f0);
  const double rtol = norm.tolerance().relative, atol = norm.tolerance().atol_x;
  const double d0 = 1 / (rtol + atol / std::max(length, 1e-6)), d1 = norm.of(f0, y0);
  const double h0 = std::min(d1 < 1e-5 ? 1e-6 : 0.01 * d0 / std::max(d1, kTiny), largest);
  copy_motion(y0, y1);
  y1.z = y0.z;
  y1.t = y0.t + h0;
  y1.q += h0 * f0.q, y1.v += h0 * f0.v;
  y1.s += h0 * f0.s;
  dynamics.rates(y1, f1);
  f1.q -= f0.q;
  f1.v -= f0.v;
  f1.s -= f0.s;
  f1.followed -= f0.followed;
  const double most = std::max(d1, norm.of(f1, y0) / h0);
  const double h1 = most <= 1e-15 ? std::max(1e-6, 1e-3 * h0) : std::pow(0.01 / most, 1.0 / (order + 1));
  return std::min({100 * h0, h1, largest});
}

}  // namespace lockstep
