#include "framework/dynamics/simulate/step_search.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include <lockstep/error.h>
#include "framework/dynamics/integrate/speed_of.h"
#include "framework/dynamics/simulate/keep_state.h"

namespace lockstep {

namespace {

double fastest_turn_at(Dynamics& dynamics, const State& state) {
  return state.coordinates ? fastest_turn(dynamics.inputs(state).motions) : fastest_turn(state.v);
}

}  // namespace

void StepSearch::begin(const State& end) {
  end_ = &end, fits_ = false;
  const State& from = interval_.from();
  const double w = std::max(fastest_turn_at(dynamics_, from), fastest_turn_at(dynamics_, end));
  turn_parts_ = std::max(1.0, std::ceil((end.t - from.t) * w / kPart));
  if (!std::isfinite(turn_parts_)) refuse();
  along_ = end.coordinates && end.coordinates->n_v() == 0 && interval_.has_dense();
}

void StepSearch::refuse() const {
  const double t0 = interval_.from().t;
  throw StepError(fmt::format("a body turns by {:.3g} rad in the step of {:.3g} s from t = {:.9g} s, beyond {:.2g} rad "
                              "no events or contacts are found inside; bound the step (--step)",
                              turn_parts_ * kPart, end_->t - t0, t0, kMost * kPart),
                  t0);
}

const std::vector<double>& StepSearch::even() {
  const double t0 = interval_.from().t, h = end_->t - t0;
  if (!(turn_parts_ <= kMost)) refuse();
  const int n = std::max(along_ ? kAlong : kLeast, static_cast<int>(turn_parts_));
  times_.clear();
  for (int k = 1; k < n; ++k) times_.push_back(t0 + h * k / n);
  return times_;
}

const std::vector<double>& StepSearch::scales() {
  constexpr int kEighths = 8;
  const double t0 = interval_.from().t;
  times_.clear();
  double window = end_->t - t0;
  for (double parts = turn_parts_; parts > kMany; parts *= 0.5, window *= 0.5)
    for (int j = kEighths - 1; j >= kEighths / 2; --j) times_.push_back(t0 + window * j / kEighths);
  for (int j = kMany - 1; j > 0; --j) times_.push_back(t0 + window * j / kMany);
  return times_;
}

const std::vector<double>& StepSearch::outputs_before(double t) {
  times_.clear();
  if (!interval_.has_dense()) return times_;
  long k = 0;
  for (double at = clock_.output_ahead(k); at < t; at = clock_.output_ahead(++k))
    if (at > interval_.from().t) times_.push_back(at);
  return times_;
}

// q by the cubic with the rates at both ends. States of other coordinates at the end have none.
void StepSearch::fit() {
  const State& from = interval_.from();
  keep_state(from, guess_);
  if (from.q.size() > 0) kinematic_rate(from, rate0_), kinematic_rate(*end_, rate1_);
  fits_ = true;
}

const State& StepSearch::look(double t) {
  if (interval_.has_dense()) return interval_.at(t);
  const State &from = interval_.from(), &to = *end_;
  if (!fits_) fit();
  const double h = to.t - from.t, x = (t - from.t) / h;
  if (from.q.size() > 0)  // from + x d + x (1 - x) [(1 - x)(h r0 - d) - x (h r1 - d)], d = to - from
    guess_.q = from.q + x * (to.q - from.q) +
               x * (1 - x) * ((1 - x) * (h * rate0_ - (to.q - from.q)) - x * (h * rate1_ - (to.q - from.q)));
  guess_.v = from.v + x * (to.v - from.v);
  guess_.s = from.s + x * (to.s - from.s);
  guess_.t = t;
  dynamics_.normalize(guess_);
  return guess_;
}

}  // namespace lockstep
