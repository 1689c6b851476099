// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include <algorithm>
#include <cmath>

namespace lockstep {

namespace {

double safety(int iterations) {
  const int twice = 2 * PredictiveControl::kMostIterations;
  return 0.9 * (twice + 1) / (twice + iterations);
}

}  // namespace

double PredictiveControl::accept(double h, double error, int iterations, bool after_rejection) {
  const double e = std::max(error, 1e-8);
  double factor = safety(iterations) * std::pow(e, -0.25);
  if (h_ > 0) factor = std::min(factor, 0.9 * (h / h_) * std::pow(std::max(error_, 1e-2) / (e * e), 0.25));
  h_ = h, error_ = e;
  factor = std::clamp(factor, 0.2, 5.0);
  return after_rejection ? std::min(factor, 1.0) : factor;
}

double PredictiveControl::reject(double error, int iterations) const {
  return std::isfinite(error) ? std::clamp(safety(iterations) * std::pow(error, -0.25), 0.2, 0.9) : 0.2;
}

}  // namespace lockstep
