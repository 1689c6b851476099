#include "integrators/stiffness.h"

#include <cmath>

namespace lockstep {

namespace {

constexpr double kWindow = 15;   // steps
constexpr double kNearly = 0.8;  // of the limit: the step swings about it
constexpr double kFast = 0.5;    // h |lambda|: of a mode that is faster than two steps
constexpr double kDamped = 0.5;  // of |lambda|: an undamped mode has 0, an overdamped one 1
constexpr double kStill = 0.1;   // of the accelerations over the window

}  // namespace

void StiffnessWatch::look(double h, double dv2, double da2, double da_dv, double change) {
  if (dv2 > 0) {  // each step with its own rate, however small its own error was
    rate2_ += h * h * da2 / dv2;
    damped_ -= h * da_dv / dv2;
  }
  if (++n_ < kWindow) return;
  const double rate = std::sqrt(rate2_ / n_), damped = damped_ / n_;
  stiff_ = damped > kDamped * rate && (rate > kNearly * limit_ || (rate > kFast && change < kStill));
  n_ = rate2_ = damped_ = 0;
}

void StiffnessWatch::save(Snapshot& out) const {
  for (const double x : {n_, rate2_, damped_, stiff_ ? 1.0 : 0.0}) out.put(x);
}

void StiffnessWatch::restore(const Snapshot& in) {
  for (double* x : {&n_, &rate2_, &damped_}) *x = in.get();
  stiff_ = in.get() != 0;
}

}  // namespace lockstep
