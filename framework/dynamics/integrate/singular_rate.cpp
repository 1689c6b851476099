#include "framework/dynamics/integrate/singular_rate.h"

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/dynamics/integrate/speed_of.h"

namespace lockstep {

namespace {

constexpr double kDelta = 1e-2;  // rad; closer to the position, the accelerations are still uncertain
constexpr double kDisagree =
    0.2;  // relative to the largest acceleration, v^2/L included: no motion changes so much within 6 delta

// The largest component; rotations are multiplied by the length L.
double largest_component(const VecX& a, double L) {
  double most = 0;
  for (Eigen::Index i = 0; i < a.size(); ++i) most = std::max(most, (i % 6 < 3 ? 1.0 : L) * std::abs(a[i]));
  return most;
}

}  // namespace

void SingularRate::begin(const State& state) {
  off_ = state;
  const StateRate scratch{VecX::Zero(state.q.size()), VecX::Zero(state.v.size()), VecX::Zero(state.s.size())};
  ahead_ = behind_ = mean_[0] = mean_[1] = mean_[2] = scratch;
}

bool SingularRate::find(Dynamics& dynamics, const State& state, StateRate& out) {
  const double L = dynamics.system().length(), speed = speed_of(state.v, L);
  if (!(speed > 0)) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const double delta = static_cast<double>(i + 1) * kDelta;
    if (!probe(dynamics, state, delta, delta / speed, mean_[i])) return false;
  }
  for (int k = 0; k < dynamics.system().n_slots(); ++k) {  // (1.8), as in Dynamics::rate
    const Quat q = Quat::from(state.q.segment<4>(7 * k + 3));
    out.q.segment<3>(7 * k) = state.v.segment<3>(6 * k);
    out.q.segment<4>(7 * k + 3) = rate(q, Vec3(state.v.segment<3>(6 * k + 3))).coefficients();
  }
  out.v = 1.5 * mean_[0].v - 0.6 * mean_[1].v + 0.1 * mean_[2].v;
  out.s = 1.5 * mean_[0].s - 0.6 * mean_[1].s + 0.1 * mean_[2].s;
  return true;
}

bool SingularRate::probe(Dynamics& dynamics, const State& state, double delta, double time, StateRate& mean) try {
  for (const double sign : {1.0, -1.0}) {
    off_ = state;
    dynamics.advance(off_, sign * time, state.v);
    off_.t = state.t + sign * time;
    if (!dynamics.project(off_, 0).converged) return false;
    dynamics.rate(off_, sign > 0 ? ahead_ : behind_);
  }
  const double L = dynamics.system().length(), speed = delta / time;
  const double scale = std::max({largest_component(ahead_.v, L), largest_component(behind_.v, L), speed * speed * L});
  if (!(largest_component(ahead_.v - behind_.v, L) <= kDisagree * scale)) return false;
  mean.v = 0.5 * (ahead_.v + behind_.v);
  mean.s = 0.5 * (ahead_.s + behind_.s);
  return true;
} catch (const Error&) {  // a law that begins or ends here: a spline, or one of a plugin or the host
  return false;
}

}  // namespace lockstep
