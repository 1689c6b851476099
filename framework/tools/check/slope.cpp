// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/check/slope.h"

#include <cmath>
#include <limits>

namespace lockstep {
namespace {

/// Weights of f(-4h) ... f(4h).
using Weights = Eigen::Vector<double, 9>;

constexpr int kFinest = 8;    // h = reach/4 ... reach/1024
constexpr double kSafe = 10;  // the error is bounded by so many times its estimate

// Central differences of order 8 and 6 (B. Fornberg, Mathematics of Computation 51 (1988) 699): of f'(0), `sign` -1, or
// f''(0), `sign` 1, where f(0) is subtracted from all.
Weights central(double sign, double a, double b, double c, double d) {
  return {sign * d, sign * c, sign * b, sign * a, 0, a, b, c, d};
}

Slope derivative(const Curve& f, double reach, int order, const Weights& w8, const Weights& w6) {
  const Weights eighth =
      Weights(1, -8, 28, -56, 70, -56, 28, -8, 1) / std::sqrt(12870.0);  // noise of the size e makes one of e
  const VecX middle = f(0);
  Slope r{VecX::Zero(middle.size()), VecX::Constant(middle.size(), std::numeric_limits<double>::infinity())};
  VecX noise;
  for (int i = kFinest; i >= 0; --i) {
    const double h = std::ldexp(reach / 4, -i), scale = std::pow(h, order);
    MatX at(middle.size(), 9);
    for (int k = -4; k <= 4; ++k) at.col(k + 4) = f(k * h);
    const VecX rounding = std::numeric_limits<double>::epsilon() * at.cwiseAbs().rowwise().maxCoeff();
    at.colwise() -= middle;
    if (i == kFinest) noise = (at * eighth).cwiseAbs();
    const VecX value = at * w8 / scale, truncation = (value - at * w6 / scale).cwiseAbs();
    const VecX error = kSafe * (truncation + (noise + rounding) * (w8.cwiseAbs().sum() / scale));
    for (Eigen::Index c = 0; c < middle.size(); ++c)
      if (error[c] < r.error[c]) r.error[c] = error[c], r.value[c] = value[c];
  }
  return r;
}

}  // namespace

Slope first_derivative(const Curve& f, double reach) {
  return derivative(f, reach, 1, central(-1, 4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280),
                    central(-1, 3.0 / 4, -3.0 / 20, 1.0 / 60, 0));
}
Slope second_derivative(const Curve& f, double reach) {
  return derivative(f, reach, 2, central(1, 8.0 / 5, -1.0 / 5, 8.0 / 315, -1.0 / 560),
                    central(1, 3.0 / 2, -3.0 / 20, 1.0 / 90, 0));
}

}  // namespace lockstep
