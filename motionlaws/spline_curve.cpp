// SPDX-License-Identifier: BSD-3-Clause
#include "motionlaws/spline_curve.h"

#include <algorithm>
#include <cmath>

#include <lockstep/author/law_checks.h>
#include <lockstep/error.h>

#include "motionlaws/side.h"

namespace lockstep {

SplineCurve::SplineCurve(const char* law, const Columns& points, const SplineSettings& k, const MatX& rates,
                         double turn)
    : law_(law), t_(points.t), k_(k), turn_(turn), n_components_(static_cast<int>(points.y.cols())) {
  check(points.y);
  for (const double r : rates.reshaped()) require_finite(law, "ends", r);
  fill(points.y, spline_nodes(points, k_.degree, k_.ends, rates, turn_));
}

void SplineCurve::check(const MatX& y) const {
  const char* law = law_.c_str();
  require(k_.degree == 3 || k_.degree == 5, law, "degree", "is " + text::number(k_.degree) + "; must be 3 or 5");
  const std::size_t n = t_.size();
  const std::size_t least =
      k_.ends == SplineEnds::periodic || (k_.degree == 5 && k_.ends == SplineEnds::natural) ? 3 : 2;
  require(n >= least, law, "points",
          "are " + text::number(static_cast<double>(n)) + "; at least " + text::number(static_cast<double>(least)) +
              " are needed");
  for (std::size_t i = 0; i < n; ++i) {
    const std::string place = "number " + text::number(static_cast<double>(i + 1)) + " of points";
    require(std::isfinite(t_[i]) && y.row(static_cast<Eigen::Index>(i)).allFinite(), law, "points",
            "have a number that is not finite in " + place);
    require(i == 0 || t_[i] > t_[i - 1], law, "points",
            "must increase in their first number; " + place + " has " + text::number(t_[i]) + ", the one before " +
                text::number(t_[i - (i > 0)]));
  }
  if (k_.ends == SplineEnds::periodic) {
    const double gap = (y.bottomRows(1) - turn_ * y.topRows(1)).cwiseAbs().maxCoeff();
    const double size = y.cwiseAbs().maxCoeff();
    require(gap <= 1e-12 * size, law, "points",
            "end " + text::number(gap) + " away from the first; with periodic ends the last must equal the first");
  }
  require(k_.outside != SplineOutside::repeat || k_.ends == SplineEnds::periodic, law, "outside",
          "is \"repeat\", which needs periodic ends; use \"hold\", or the law 'repeat' around this one");
}

// Hermite's form of an interval of length h, with dy = y1 - y0 and so on:
//   cubic    c2 = (3 dy - (2 s0 + s1) h)/h^2,  c3 = (-2 dy + (s0 + s1) h)/h^3
//   quintic  c2 = M0/2 and, with D = dy - s0 h - M0 h^2/2, S = (s1 - s0 - M0 h) h, C = (M1 - M0) h^2:
//            c3 = (10 D - 4 S + C/2)/h^3,  c4 = (-15 D + 7 S - C)/h^4,  c5 = (6 D - 3 S + C/2)/h^5
void SplineCurve::fill(const MatX& y, const MatX& x) {
  const auto n = static_cast<Eigen::Index>(t_.size()) - 1;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double h = t_[i + 1] - t_[i], h2 = h * h, h3 = h2 * h;
    for (Eigen::Index j = 0; j < n_components_; ++j) {
      const double dy = y(i + 1, j) - y(i, j);
      if (k_.degree == 3) {
        const double s0 = x(i, j), s1 = x(i + 1, j);
        c_.insert(c_.end(), {y(i, j), s0, (3 * dy - (2 * s0 + s1) * h) / h2, ((s0 + s1) * h - 2 * dy) / h3});
        continue;
      }
      const double s0 = x(2 * i, j), m0 = x(2 * i + 1, j), s1 = x(2 * i + 2, j), m1 = x(2 * i + 3, j);
      const double D = dy - s0 * h - 0.5 * m0 * h2, S = (s1 - s0 - m0 * h) * h, C = (m1 - m0) * h2;
      c_.insert(c_.end(), {y(i, j), s0, 0.5 * m0, (10 * D - 4 * S + 0.5 * C) / h3, (7 * S - 15 * D - C) / (h3 * h),
                           (6 * D - 3 * S + 0.5 * C) / (h3 * h2)});
    }
  }
  // At rest at an end if its rates are only roundings, relative to the mean rates over the range.
  const double T = last() - first(), size = y.cwiseAbs().maxCoeff();
  const auto rests = [&](double t) {
    std::vector<double> v(3 * static_cast<std::size_t>(n_components_));
    double* p = v.data();
    const SplineOutside outside = std::exchange(k_.outside, SplineOutside::refuse);  // the curve itself, at its end
    at(t, p, p + n_components_, p + 2 * n_components_);
    k_.outside = outside;
    for (int j = 0; j < n_components_; ++j)
      if (std::abs(p[n_components_ + j]) * T > 1e-11 * size || std::abs(p[2 * n_components_ + j]) * T * T > 1e-9 * size)
        return false;
    return true;
  };
  rest_at_first_ = rests(first());
  rest_at_last_ = rests(last());
}

void SplineCurve::at(double t, double* y, double* yd, double* ydd) const {
  const double T = last() - first();
  double sign = 1, go_on = 1;  // go_on is 0 where the value is held
  if (k_.outside == SplineOutside::repeat) {
    const double s = std::fmod(t - first(), T), into = s < 0 ? s + T : s;
    if (turn_ < 0 && std::fmod(std::round((t - first() - into) / T), 2.0) != 0) sign = -1;
    t = first() + into;
  } else if (k_.outside == SplineOutside::hold) {
    if (t < first() - kEarly * T || t >= last() - kEarly * T) go_on = 0;
    t = std::clamp(t, first(), last());
  } else if (!(t >= first() - 1e-9 * T && t <= last() + 1e-9 * T)) {  // with slack for sums of steps
    throw ModelError("law '" + law_ + "' has points from " + text::brief(first()) + " to " + text::brief(last()) +
                     " and no value at " + text::number(t) + "; add points, or set \"outside\" to \"" +
                     (k_.ends == SplineEnds::periodic ? "repeat" : "hold") + "\"");
  }
  const auto next = std::upper_bound(t_.begin() + 1, t_.end() - 1, t);
  const std::size_t i = static_cast<std::size_t>(next - t_.begin()) - 1;
  const std::size_t n_powers = static_cast<std::size_t>(k_.degree) + 1;
  const double u = t - t_[i];
  const double* c = c_.data() + i * static_cast<std::size_t>(n_components_) * n_powers;
  for (int j = 0; j < n_components_; ++j, c += n_powers) {
    double p = 0, p1 = 0, p2 = 0;
    for (std::size_t k = n_powers; k-- > 0;) {
      p2 = p2 * u + 2 * p1;
      p1 = p1 * u + p;
      p = p * u + c[k];
    }
    y[j] = sign * p;
    yd[j] = sign * go_on * p1;
    ydd[j] = sign * go_on * p2;
  }
}

bool SplineCurve::is_constant(const VecX& weights) const {
  const std::size_t n_powers = static_cast<std::size_t>(k_.degree) + 1, n = static_cast<std::size_t>(n_components_);
  double size = 0;
  for (std::size_t i = 0; i < c_.size(); i += n_powers) size = std::max(size, std::abs(c_[i]));
  for (std::size_t i = 0; i + 1 < t_.size(); ++i) {
    double h_to_k = 1;
    for (std::size_t k = 1; k < n_powers; ++k) {
      h_to_k *= t_[i + 1] - t_[i];
      double sum = 0;
      for (std::size_t j = 0; j < n; ++j) sum += weights[static_cast<Eigen::Index>(j)] * c_[(i * n + j) * n_powers + k];
      if (std::abs(sum) * h_to_k > kParallel * size) return false;
    }
  }
  return true;
}

void SplineCurve::breakpoints(double t0, double t1, std::vector<double>& out) const {
  if (k_.outside != SplineOutside::hold) return;
  if (!rest_at_first_ && t0 < first() && first() < t1) out.push_back(first());
  if (!rest_at_last_ && t0 < last() && last() < t1) out.push_back(last());
}

}  // namespace lockstep
