// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include <cmath>

namespace lockstep {

namespace {

constexpr double kWindow = 15;   // steps
constexpr double kNearly = 0.8;  // of the stability limit, about which the step oscillates
constexpr double kDamped = 0.5;  // damped part of |lambda|: 0 for an undamped mode, 1 for an overdamped one

}  // namespace

void StiffnessWatch::begin() {
  n_ = rate2_ = damped_ = 0;
  stiff_ = false;
}

void StiffnessWatch::observe(double h, const VecX& dv, const VecX& a_stage, const VecX& a_end, double length) {
  const double L2 = length * length;
  double dv2 = 0, da2 = 0, da_dv = 0;
  for (Eigen::Index i = 0; i < a_end.size(); ++i) {
    const double da = a_end[i] - a_stage[i], weight = i % 6 < 3 ? 1.0 : L2;
    dv2 += weight * dv[i] * dv[i], da2 += weight * da * da, da_dv += weight * da * dv[i];
  }
  add(h, dv2, da2, da_dv);
}

void StiffnessWatch::add(double h, double dv2, double da2, double da_dv) {
  if (dv2 > 0) {  // each step counts with its own rate, however small its error was
    rate2_ += h * h * da2 / dv2;
    damped_ -= h * da_dv / dv2;
  }
  if (++n_ < kWindow) return;
  const double rate = std::sqrt(rate2_ / n_), damped = damped_ / n_;
  stiff_ = damped > kDamped * rate && rate > kNearly * limit_;
  n_ = rate2_ = damped_ = 0;
}

void StiffnessWatch::save(Snapshot& out) const {
  for (const double x : {n_, rate2_, damped_, stiff_ ? 1.0 : 0.0}) out.put(x);
}

void StiffnessWatch::restore(SnapshotReader& in) {
  for (double* x : {&n_, &rate2_, &damped_}) *x = in.get();
  stiff_ = in.get_flag();
}

}  // namespace lockstep
