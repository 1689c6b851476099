// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

namespace lockstep {

void LinearizedMotion::begin(const State& state) {
  const Eigen::Index n = state.v.size();
  for (VecX* v : {&p_, &p_im_, &force_, &force_im_, &al_}) v->setZero(n);
  for (VecXc* v : {&force_c_, &al_c_}) v->setZero(n);
  matrix_.set_residual(1e-6);  // the linearisation neglects more
}

void LinearizedMotion::gather(const Solution& solution) {
  matrix_.gather(solution.evaluation, solution.lambda);
  rows_.setZero(solution.rows.n_rows);
  rows_c_.setZero(solution.rows.n_rows);
}

void LinearizedMotion::factor(double g) { matrix_.factor(1, 1 / g, 1 / (g * g)); }

void LinearizedMotion::factor(Complex g) { matrix_.factor(Complex(1), 1.0 / g, 1.0 / (g * g)); }

// With dv = (al + r_v)/g and dq = (dv + r_q)/g:
//   (M + D/g + K/g^2) al + Jh^T l = -(D r_v + K (r_q + r_v/g))/g,   Jh al = 0
void LinearizedMotion::solve(double g, const VecX& r, VecX& y) {
  const Eigen::Index n = al_.size(), n_s = r.size() - 2 * n;
  force_.setZero();
  p_ = r.segment(n, n);
  matrix_.add_D_times(p_, force_);
  p_ = r.head(n) + p_ / g;
  matrix_.add_K_times(p_, force_);
  force_ *= -1 / g;
  matrix_.solve(force_, rows_, al_, l_);
  y.segment(n, n) = (al_ + r.segment(n, n)) / g;
  y.head(n) = (y.segment(n, n) + r.head(n)) / g;
  y.tail(n_s) = r.tail(n_s) / g;
}

// The same; K and D are real, so they multiply both parts in turn.
void LinearizedMotion::solve(Complex g, const VecX& r_re, const VecX& r_im, VecX& y_re, VecX& y_im) {
  const Eigen::Index n = al_.size(), n_s = r_re.size() - 2 * n;
  const Complex s = 1.0 / g;
  const double a = s.real(), b = s.imag();
  force_.setZero(), force_im_.setZero();
  p_ = r_re.segment(n, n), p_im_ = r_im.segment(n, n);
  matrix_.add_D_times(p_, force_);
  matrix_.add_D_times(p_im_, force_im_);
  p_ = r_re.head(n) + a * r_re.segment(n, n) - b * r_im.segment(n, n);
  p_im_ = r_im.head(n) + b * r_re.segment(n, n) + a * r_im.segment(n, n);
  matrix_.add_K_times(p_, force_);
  matrix_.add_K_times(p_im_, force_im_);
  force_c_.real() = -a * force_ + b * force_im_;
  force_c_.imag() = -b * force_ - a * force_im_;
  matrix_.solve(force_c_, rows_c_, al_c_, l_c_);
  const auto put = [&](Eigen::Index k, Complex x) { y_re[k] = x.real(), y_im[k] = x.imag(); };
  for (Eigen::Index k = 0; k < n; ++k) {
    const Complex dv = s * (al_c_[k] + Complex(r_re[n + k], r_im[n + k]));
    put(n + k, dv);
    put(k, s * (dv + Complex(r_re[k], r_im[k])));
  }
  for (Eigen::Index k = 2 * n; k < 2 * n + n_s; ++k) put(k, s * Complex(r_re[k], r_im[k]));
}

}  // namespace lockstep
