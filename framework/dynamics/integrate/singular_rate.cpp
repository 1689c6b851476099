#include "framework/dynamics/integrate/singular_rate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <lockstep/error.h>
#include <lockstep/stepping.h>
#include "framework/dynamics/integrate/speed_of.h"

namespace lockstep {

namespace {

// Relative to the largest acceleration, v^2/L included: no motion changes so much within 2 d.
constexpr double kDisagree = 0.2;

// Of the means at d to 4 d, and at d to 3 d.
constexpr std::array kWeights = {56.0 / 35, -28.0 / 35, 8.0 / 35, -1.0 / 35};
constexpr std::array kShorter = {1.5, -0.6, 0.1, 0.0};

// The largest component; rotations of slots are multiplied by the length L.
template <class Vector>  // an expression, too
double largest_component(const State& of, const Eigen::MatrixBase<Vector>& a, double L) {
  if (of.coordinates) return a.template lpNorm<Eigen::Infinity>();
  double most = 0;
  for (Eigen::Index i = 0; i < a.size(); ++i) most = std::max(most, (i % 6 < 3 ? 1.0 : L) * std::abs(a[i]));
  return most;
}

}  // namespace

void SingularRate::begin(const State& state) {
  ahead_ = behind_ = {state, sized_like(state)};
  v_ = state.v, shorter_ = ahead_.rate.v;
}

SingularRate::Sides SingularRate::find(Dynamics& dynamics, State& state, double detector, StateRate& out) {
  const double L = dynamics.system().length();
  const double speed = state.coordinates ? state.v.lpNorm<Eigen::Infinity>() : speed_of(state.v, L);
  distance_ = largest_ = 0;
  if (!(speed > 0)) return Sides::differ;
  for (VecX* x : {&out.q, &out.v, &out.s, &out.followed, &v_, &shorter_}) x->setZero();
  for (std::size_t i = 0; i < kWeights.size(); ++i) {
    const double angle = static_cast<double>(i + 1) * kDelta;
    if (!probe(dynamics, state, angle, angle / speed, i, out)) return Sides::differ;
    if (i > 0) continue;
    distance_ = kDelta * std::sqrt(detector / detector_);  // the detector falls as the square of the distance
    if (!(2 * distance_ < kDelta)) return Sides::farther;
  }
  state.q += out.q, state.v += v_;
  out.largest_a = ahead_.rate.largest_a, out.largest_alpha = ahead_.rate.largest_alpha;
  shorter_ -= out.v;
  error_ = largest_component(state, shorter_, L) / largest_;
  dynamics.normalize(state);
  kinematic_rate(state, out.q);
  return Sides::agree;
}

bool SingularRate::probe(Dynamics& dynamics, const State& state, double angle, double time, std::size_t i,
                         StateRate& out) try {
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
  if (i == 0 && !(largest_component(state, ahead_.rate.v - behind_.rate.v, L) <= kDisagree * scale)) return false;
  for (const Side* side : {&ahead_, &behind_}) {
    const double w = 0.5 * kWeights[i];
    out.q += w * (side->at.q - state.q), v_ += w * (side->at.v - state.v);  // whose rounding is small
    out.v += w * side->rate.v, out.s += w * side->rate.s, out.followed += w * side->rate.followed;
    shorter_ += 0.5 * kShorter[i] * side->rate.v;
  }
  largest_ = std::max(largest_, scale);
  return true;
} catch (const Error&) {  // a law that begins or ends here: a spline, or one of a plugin or the host
  return false;
}

}  // namespace lockstep
