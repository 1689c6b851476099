#include "framework/tools/check/slope.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lockstep {
namespace {

constexpr int kSteps = 9;     // h = reach/4 ... reach/1024
constexpr double kSafe = 10;  // the error is bounded by so many times its estimate
constexpr double kRound = std::numeric_limits<double>::epsilon();

// Central differences of order 8 and 6 (B. Fornberg, Mathematics of Computation 51 (1988) 699).
struct Weights {
  std::array<double, 4> w8, w6;
  double sum;  // of |w8|: how much noise comes through
};
constexpr Weights kFirstDerivative{{4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280}, {3.0 / 4, -3.0 / 20, 1.0 / 60, 0}, 2.1};
constexpr Weights kSecondDerivative{{8.0 / 5, -1.0 / 5, 8.0 / 315, -1.0 / 560}, {3.0 / 2, -3.0 / 20, 1.0 / 90, 0}, 6.6};

struct Points {
  VecX at[9];  // f(-4h) ... f(4h)
  const VecX& operator[](int k) const { return at[k + 4]; }
};

// The eighth difference: noise of the size e makes one of sqrt(12870) e.
VecX noise_of(const Points& p) {
  constexpr double c[5] = {70, -56, 28, -8, 1};
  VecX d = c[0] * p[0];
  for (int k = 1; k <= 4; ++k) d += c[k] * (p[k] + p[-k]);
  return d.cwiseAbs() / std::sqrt(12870.0);
}

Slope derivative(const Curve& f, double reach, const Weights& w, int order) {
  std::array<Points, kSteps> all;
  for (int i = 0; i < kSteps; ++i) {
    const double h = std::ldexp(reach / 4, -i);
    for (int k = -4; k <= 4; ++k) {
      VecX& out = all[static_cast<std::size_t>(i)].at[k + 4];
      if (k == 0 && i > 0)
        out = all[0][0];
      else
        f(k * h, out);
    }
  }
  const VecX& middle = all[0][0];
  const Eigen::Index n = middle.size();
  Slope r{VecX::Zero(n), VecX::Constant(n, std::numeric_limits<double>::infinity()), middle.cwiseAbs()};
  const VecX measured = noise_of(all[kSteps - 1]);
  for (int i = 0; i < kSteps; ++i) {
    const Points& p = all[static_cast<std::size_t>(i)];
    const double h = std::ldexp(reach / 4, -i), scale = order == 1 ? h : h * h;
    for (Eigen::Index c = 0; c < n; ++c) {
      double d8 = 0, d6 = 0, size = std::abs(middle[c]);
      for (int k = 1; k <= 4; ++k) {
        const double d = order == 1 ? p[k][c] - p[-k][c] : (p[k][c] - middle[c]) + (p[-k][c] - middle[c]);
        d8 += w.w8[static_cast<std::size_t>(k - 1)] * d / scale;
        d6 += w.w6[static_cast<std::size_t>(k - 1)] * d / scale;
        size = std::max({size, std::abs(p[k][c]), std::abs(p[-k][c])});
      }
      const double noise = std::max(measured[c], kRound * size) * w.sum / scale;
      const double error = kSafe * (std::abs(d8 - d6) + noise);
      if (error < r.error[c]) r.error[c] = error, r.value[c] = d8;
      r.size[c] = std::max(r.size[c], size);
    }
  }
  return r;
}

}  // namespace

Slope first_derivative(const Curve& f, double reach) { return derivative(f, reach, kFirstDerivative, 1); }
Slope second_derivative(const Curve& f, double reach) { return derivative(f, reach, kSecondDerivative, 2); }

}  // namespace lockstep
