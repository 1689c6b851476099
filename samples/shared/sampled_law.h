// SPDX-License-Identifier: BSD-3-Clause
// A law through what was recorded.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <lockstep/author/law.h>

namespace lockstep::samples {

/// A law through values with their first and second derivatives: one polynomial of degree 5 between two samples.
class Sampled final : public MotionLaw {
 public:
  Sampled(std::vector<LawValue> samples, double interval) : y_(std::move(samples)), h_(interval) {}
  LawValue at(double t) const override {
    const double h = h_;
    const auto i = static_cast<std::size_t>(std::clamp(std::floor(t / h), 0.0, double(y_.size() - 2)));
    const LawValue &a = y_[i], &b = y_[i + 1];
    const double u = t / h - double(i);
    const double c0 = a.y, c1 = h * a.yd, c2 = 0.5 * h * h * a.ydd;
    const double p = b.y - c0 - c1 - c2, v = h * b.yd - c1 - 2 * c2, w = h * h * b.ydd - 2 * c2;
    const double c3 = 10 * p - 4 * v + 0.5 * w, c4 = -15 * p + 7 * v - w, c5 = 6 * p - 3 * v + 0.5 * w;
    return {c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5)))),
            (c1 + u * (2 * c2 + u * (3 * c3 + u * (4 * c4 + u * 5 * c5)))) / h,
            (2 * c2 + u * (6 * c3 + u * (12 * c4 + u * 20 * c5))) / (h * h)};
  }

 private:
  std::vector<LawValue> y_;
  double h_;  // s
};

}  // namespace lockstep::samples
