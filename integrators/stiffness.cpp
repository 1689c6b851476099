#include <lockstep/integrators.h>

#include <cmath>

namespace lockstep {

namespace {

constexpr double kWindow = 15;   // steps
constexpr double kNearly = 0.8;  // of the stability limit, about which the step oscillates
constexpr double kFast = 0.5;    // h |lambda|: of a mode that is faster than two steps
constexpr double kDamped = 0.5;  // damped part of |lambda|: 0 for an undamped mode, 1 for an overdamped one
constexpr double kStill = 0.1;   // largest relative change of the accelerations over the window

}  // namespace

void StiffnessWatch::begin(Eigen::Index n_velocities) {
  n_ = rate2_ = damped_ = 0;
  stiff_ = false;
  a_before_.setZero(n_velocities);
}

void StiffnessWatch::observe(double h, const VecX& dv, const VecX& a_stage, const VecX& a_end, double length) {
  const double L2 = length * length;
  if (n_ == 0) a_before_ = a_end;
  double dv2 = 0, da2 = 0, da_dv = 0, a2 = 0, change2 = 0;
  for (Eigen::Index i = 0; i < a_end.size(); ++i) {
    const double da = a_end[i] - a_stage[i], change = a_end[i] - a_before_[i], weight = i % 6 < 3 ? 1.0 : L2;
    dv2 += weight * dv[i] * dv[i], da2 += weight * da * da, da_dv += weight * da * dv[i];
    a2 += weight * a_end[i] * a_end[i], change2 += weight * change * change;
  }
  add(h, dv2, da2, da_dv, a2 > 0 ? std::sqrt(change2 / a2) : 1.0);
}

void StiffnessWatch::add(double h, double dv2, double da2, double da_dv, double change) {
  if (dv2 > 0) {  // each step counts with its own rate, however small its error was
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
  out.put_all(a_before_);
}

void StiffnessWatch::restore(SnapshotReader& in) {
  for (double* x : {&n_, &rate2_, &damped_}) *x = in.get();
  stiff_ = in.get_flag();
  const Eigen::Index own = a_before_.size();  // by begin()
  in.get_all(a_before_);
  if (a_before_.size() != own) throw ModelError("the saved history of the steps is that of another mechanism");
}

}  // namespace lockstep
