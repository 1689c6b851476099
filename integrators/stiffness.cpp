#include "integrators/stiffness.h"

namespace lockstep {

namespace {

constexpr double kWindow = 15;   // steps
constexpr double kNearly = 0.8;  // of the limit: the step swings about it
constexpr double kDamped = 0.5;  // of |lambda|: an undamped mode has 0, an overdamped one 1

}  // namespace

void StiffnessWatch::look(double h, double dv2, double da2, double da_dv) {
  if (dv2 > 0) {  // of equal weight, however small the step's own error was
    dv2_ += 1;
    da2_ += h * h * da2 / dv2;
    damped_ -= h * da_dv / dv2;
  }
  if (++n_ < kWindow) return;
  const double rate = dv2_ > 0 ? da2_ / dv2_ : 0, limit = kNearly * limit_;
  stiff_ = rate > limit * limit && damped_ > 0 && damped_ * damped_ > kDamped * kDamped * da2_ * dv2_;
  n_ = dv2_ = da2_ = damped_ = 0;
}

void StiffnessWatch::save(Snapshot& out) const {
  for (const double x : {n_, dv2_, da2_, damped_, stiff_ ? 1.0 : 0.0}) out.put(x);
}

void StiffnessWatch::restore(const Snapshot& in) {
  for (double* x : {&n_, &dv2_, &da2_, &damped_}) *x = in.get();
  stiff_ = in.get() != 0;
}

}  // namespace lockstep
