// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/evaluate/singular_rate.h"

#include <array>

#include <lockstep/author/passes.h>
#include <lockstep/error.h>
#include "framework/dynamics/evaluate/speed_of.h"
#include "framework/foundation/math/limits.h"

namespace lockstep {

namespace {

// Relative to the largest acceleration, v^2/L included: no motion jumps so much.
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
  ahead_ = behind_ = {state, sized_like(state), {}, 0};
  v_ = halfway_ = state.v, shorter_ = odd_ = ahead_.rate.v;
}

SingularRate::Sides SingularRate::find(Dynamics& dynamics, State& state, double detector, StateRate& out) {
  const double L = dynamics.system().length();
  passes::motions(dynamics.system(), state, motions_);
  const double speed = speed_of(motions_, L);
  distance_ = HUGE_VAL, largest_ = root_ = largest_lambda_ = multiplier_error_ = 0;
  if (!(speed > 0)) return Sides::differ;
  distance_ = std::sqrt(detector);
  for (VecX* x : {&out.q, &out.v, &out.s, &out.followed, &v_, &shorter_}) x->setZero();
  for (std::size_t i = 0; i < kWeights.size(); ++i) {
    if (!probe(dynamics, state, speed, detector, i, out)) return Sides::differ;
    if (!(2 * distance_ < kDelta)) return Sides::farther;
  }
  state.q += out.q, state.v += v_;
  out.largest_a = ahead_.rate.largest_a, out.largest_alpha = ahead_.rate.largest_alpha;
  error_ = largest_component(state, shorter_ - out.v, L) / largest_;
  find_multipliers();
  dynamics.normalize(state);
  kinematic_rate(state, out.q);
  return Sides::agree;
}

void SingularRate::find_multipliers() {
  if (!(largest_lambda_ > 0)) return;
  multiplier_error_ = (shorter_lambda_ - lambda_).lpNorm<Eigen::Infinity>() / largest_lambda_;
  for (Eigen::Index k = 0; k < lambda_.size(); ++k)
    if (std::abs(pole_[k]) > std::max(kSlight, multiplier_error_) * largest_lambda_) lambda_[k] = NAN;
}

bool SingularRate::probe(Dynamics& dynamics, const State& state, double speed, double detector, std::size_t i,
                         StateRate& out) try {
  const double time = static_cast<double>(i + 1) * kDelta / speed;
  for (const double sign : {1.0, -1.0}) {
    Side& side = sign > 0 ? ahead_ : behind_;
    State& at = side.at;
    const auto go = [&](double h, const VecX& v) {
      at = state;
      dynamics.advance(at, h, v);
      at.t = state.t + h;
      if (!dynamics.project(at, 0).converged) return false;
      at.v = state.v;  // by the factor of this position; of a tree to the goal only, as more rounds are noise
      return at.coordinates ? (dynamics.project_velocity(at), true) : dynamics.project(at, 0).converged;
    };
    if (!go(0.5 * sign * time, state.v) || !go(sign * time, halfway_ = at.v)) return false;
    if (at.coordinates) {
      side.root = std::sqrt(dynamics.rates_with_report(at, side.rate).detector);
      continue;
    }
    const Solution& solution = dynamics.rate(at, side.rate);
    side.root = std::sqrt(solution.full_report().detector), side.lambda = solution.lambda;
  }
  if (i == 0) slope_ = std::sqrt(ahead_.root * behind_.root), distance_ = kDelta * std::sqrt(detector) / slope_;
  if (i == 1) grows_ = ahead_.root + behind_.root > 3 * slope_;
  root_ += 0.5 * kWeights[i] * (ahead_.root - behind_.root);
  const double L = dynamics.system().length();
  const double scale =
      std::max({largest_component(state, ahead_.rate.v, L), largest_component(state, behind_.rate.v, L),
                speed * speed * (state.coordinates ? 1 : L)});
  if (i == 0) odd_ = 2 * (ahead_.rate.v - behind_.rate.v);
  if (i == 1) odd_ -= ahead_.rate.v - behind_.rate.v;
  if (i == 1 && !(largest_component(state, odd_, L) <= kDisagree * scale)) return false;
  for (const Side* side : {&ahead_, &behind_}) {
    const double w = 0.5 * kWeights[i];
    out.q += w * (side->at.q - state.q), v_ += w * (side->at.v - state.v);  // whose rounding is small
    out.v += w * side->rate.v, out.s += w * side->rate.s, out.followed += w * side->rate.followed;
    shorter_ += 0.5 * kShorter[i] * side->rate.v;
  }
  largest_ = std::max(largest_, scale);
  if (state.coordinates) return true;
  if (i == 0)
    for (VecX* x : {&lambda_, &shorter_lambda_, &pole_}) x->setZero(ahead_.lambda.size());
  for (const Side* side : {&ahead_, &behind_}) {
    const double w = 0.5 * kWeights[i], place = (side == &ahead_ ? 1 : -1) * static_cast<double>(i + 1);
    lambda_ += w * side->lambda, pole_ += w * place * side->lambda;
    shorter_lambda_ += 0.5 * kShorter[i] * side->lambda;
    largest_lambda_ = std::max(largest_lambda_, side->lambda.lpNorm<Eigen::Infinity>());
  }
  return true;
} catch (const Error&) {  // a law that begins or ends here: a spline, or one of a plugin or the host
  return false;
}

}  // namespace lockstep
