#include "framework/dynamics/integrate/singular_rate.h"

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include <lockstep/stepping.h>

namespace lockstep {

namespace {

// Relative to the largest acceleration, v^2/L included: no motion changes so much within 2 d.
constexpr double kDisagree = 0.2;

// The largest component; rotations of slots are multiplied by the length L.
template <class Vector>  // an expression, too
double largest_component(const State& of, const Eigen::MatrixBase<Vector>& a, double L) {
  if (of.coordinates) return a.template lpNorm<Eigen::Infinity>();
  double most = 0;
  for (Eigen::Index i = 0; i < a.size(); ++i) most = std::max(most, (i % 6 < 3 ? 1.0 : L) * std::abs(a[i]));
  return most;
}

}  // namespace

void SingularRate::size_for(const State& state) {
  if (ahead_.at.q.size() == state.q.size() && ahead_.at.coordinates == state.coordinates) return;
  ahead_ = behind_ = {state, sized_like(state)};
  mean_.fill(ahead_);
  motions_.resize(static_cast<std::size_t>(state.coordinates ? state.coordinates->n_slots() : state.v.size() / 6) + 1);
}

SingularRate::Sides SingularRate::find(Dynamics& dynamics, State& state, double detector, StateRate& out) {
  size_for(state);
  const double L = dynamics.system().length();
  double speed = 0;
  dynamics.system().motions(state, motions_);
  for (const Motion& O : motions_) speed = std::max({speed, O.v.norm() / L, O.w.norm()});
  distance_ = largest_ = 0;
  if (!(speed > 0)) return Sides::differ;
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    const double angle = static_cast<double>(i + 1) * kDelta;
    if (!probe(dynamics, state, angle, angle / speed, i)) return Sides::differ;
    if (i > 0) continue;
    distance_ = kDelta * std::sqrt(detector / detector_);  // the detector falls as the square of the distance
    if (!(2 * distance_ < kDelta)) return Sides::farther;
  }
  const auto limit = [&](auto&& part, VecX& x) {
    x = (56 * part(mean_[0]) - 28 * part(mean_[1]) + 8 * part(mean_[2]) - part(mean_[3])) / 35;
  };
  limit([](const Side& m) -> const VecX& { return m.at.q; }, state.q);
  limit([](const Side& m) -> const VecX& { return m.at.v; }, state.v);
  limit([](const Side& m) -> const VecX& { return m.rate.v; }, out.v);
  limit([](const Side& m) -> const VecX& { return m.rate.s; }, out.s);
  limit([](const Side& m) -> const VecX& { return m.rate.followed; }, out.followed);
  out.largest_a = ahead_.rate.largest_a, out.largest_alpha = ahead_.rate.largest_alpha;
  ahead_.rate.v = 1.5 * mean_[0].rate.v - 0.6 * mean_[1].rate.v + 0.1 * mean_[2].rate.v - out.v;
  error_ = largest_component(state, ahead_.rate.v, L) / largest_;
  dynamics.normalize(state);
  kinematic_rate(state, out.q);
  return Sides::agree;
}

bool SingularRate::probe(Dynamics& dynamics, const State& state, double angle, double time, std::size_t i) try {
  detector_ = 1;
  for (const double sign : {1.0, -1.0}) {
    auto& [at, rate] = sign > 0 ? ahead_ : behind_;
    at = state;
    dynamics.advance(at, sign * time, state.v);
    at.t = state.t + sign * time;
    if (!dynamics.project(at, 0).converged) return false;
    if (!at.coordinates) dynamics.project(at, 0);  // the velocities once more, with the factor of this position
    detector_ *= std::sqrt(dynamics.rates_with_report(at, rate).detector);
  }
  const double L = dynamics.system().length(), speed = angle / time;
  const double scale =
      std::max({largest_component(state, ahead_.rate.v, L), largest_component(state, behind_.rate.v, L),
                speed * speed * (state.coordinates ? 1 : L)});
  const bool nearest = i == 0;  // farther off what turns with the bodies differs by as much
  if (nearest && !(largest_component(state, ahead_.rate.v - behind_.rate.v, L) <= kDisagree * scale)) return false;
  Side& mean = mean_[i];
  mean.at.q = 0.5 * (ahead_.at.q + behind_.at.q), mean.at.v = 0.5 * (ahead_.at.v + behind_.at.v);
  mean.rate.v = 0.5 * (ahead_.rate.v + behind_.rate.v), mean.rate.s = 0.5 * (ahead_.rate.s + behind_.rate.s);
  mean.rate.followed = 0.5 * (ahead_.rate.followed + behind_.rate.followed);
  largest_ = std::max(largest_, scale);
  return true;
} catch (const Error&) {  // a law that begins or ends here: a spline, or one of a plugin or the host
  return false;
}

}  // namespace lockstep
