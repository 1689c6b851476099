#include "framework/dynamics/integrate/singular_rate.h"

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/dynamics/integrate/speed_of.h"

namespace lockstep {

namespace {

// Relative to the largest acceleration, v^2/L included: no motion changes so much within 8 d.
constexpr double kDisagree = 0.2;

// The largest component; rotations are multiplied by the length L.
double largest_component(const VecX& a, double L) {
  double most = 0;
  for (Eigen::Index i = 0; i < a.size(); ++i) most = std::max(most, (i % 6 < 3 ? 1.0 : L) * std::abs(a[i]));
  return most;
}

}  // namespace

void SingularRate::begin(const State& state) {
  const StateRate scratch{VecX::Zero(state.q.size()), VecX::Zero(state.v.size()), VecX::Zero(state.s.size())};
  ahead_ = behind_ = {state, scratch};
  mean_.fill(ahead_);
}

SingularRate::Sides SingularRate::find(Dynamics& dynamics, State& state, double detector, StateRate& out) {
  const double L = dynamics.system().length(), speed = speed_of(state.v, L);
  distance_ = largest_ = 0;
  if (!(speed > 0)) return Sides::differ;
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    const double angle = static_cast<double>(i + 1) * kDelta;
    if (!probe(dynamics, state, angle, angle / speed, i)) return Sides::differ;
    if (i > 0) continue;
    distance_ = kDelta * std::sqrt(detector / detector_);  // the detector falls as the square of the distance
    if (!(distance_ < 0.5 * kDelta)) return Sides::farther;
  }
  const auto limit = [&](auto&& part, VecX& x) {
    x = (56 * part(mean_[0]) - 28 * part(mean_[1]) + 8 * part(mean_[2]) - part(mean_[3])) / 35;
  };
  limit([](const Side& m) -> const VecX& { return m.at.q; }, state.q);
  limit([](const Side& m) -> const VecX& { return m.at.v; }, state.v);
  limit([](const Side& m) -> const VecX& { return m.rate.v; }, out.v);
  limit([](const Side& m) -> const VecX& { return m.rate.s; }, out.s);
  ahead_.rate.v = 1.5 * mean_[0].rate.v - 0.6 * mean_[1].rate.v + 0.1 * mean_[2].rate.v - out.v;
  error_ = largest_component(ahead_.rate.v, L) / largest_;
  dynamics.normalize(state);
  for (int k = 0; k < dynamics.system().n_slots(); ++k) {  // (1.8), as in Dynamics::rate
    const Quat q = Quat::from(state.q.segment<4>(7 * k + 3));
    out.q.segment<3>(7 * k) = state.v.segment<3>(6 * k);
    out.q.segment<4>(7 * k + 3) = rate(q, Vec3(state.v.segment<3>(6 * k + 3))).coefficients();
  }
  return Sides::agree;
}

bool SingularRate::probe(Dynamics& dynamics, const State& state, double angle, double time, std::size_t i) try {
  detector_ = 1;
  for (const double sign : {1.0, -1.0}) {
    auto& [at, rate] = sign > 0 ? ahead_ : behind_;
    at = state;
    dynamics.advance(at, sign * time, state.v);
    at.t = state.t + sign * time;
    for (int round = 0; round < 2; ++round)  // once more for the velocities, with the factor of this position
      if (!dynamics.project(at, 0).converged) return false;
    detector_ *= std::sqrt(dynamics.rates_with_report(at, rate).detector);
  }
  const double L = dynamics.system().length(), speed = angle / time;
  const double scale =
      std::max({largest_component(ahead_.rate.v, L), largest_component(behind_.rate.v, L), speed * speed * L});
  if (!(largest_component(ahead_.rate.v - behind_.rate.v, L) <= kDisagree * scale)) return false;
  Side& mean = mean_[i];
  mean.at.q = 0.5 * (ahead_.at.q + behind_.at.q), mean.at.v = 0.5 * (ahead_.at.v + behind_.at.v);
  mean.rate.v = 0.5 * (ahead_.rate.v + behind_.rate.v), mean.rate.s = 0.5 * (ahead_.rate.s + behind_.rate.s);
  largest_ = std::max(largest_, scale);
  return true;
} catch (const Error&) {  // a law that begins or ends here: a spline, or one of a plugin or the host
  return false;
}

}  // namespace lockstep
