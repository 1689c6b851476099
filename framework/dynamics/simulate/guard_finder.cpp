// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/simulate/guard_finder.h"

#include <spdlog/fmt/fmt.h>

#include <lockstep/error.h>
#include "framework/dynamics/evaluate/speed_of.h"
#include "framework/dynamics/simulate/keep_state.h"
#include "framework/dynamics/simulate/line_search.h"
#include "framework/dynamics/simulate/uncounted.h"

namespace lockstep {

namespace {

constexpr int kLeast = 4;          // parts at least, where a step is looked at inside
constexpr double kMost = 1e6;      // parts at most
constexpr double kEighth = 0.125;  // of 180 deg, rotation of a body in a part; of the time since the start of a step

double fastest_turn_at(Dynamics& dynamics, const State& state) {
  return state.coordinates ? fastest_turn(dynamics.inputs(state).motions) : fastest_turn(state.v);
}

double rounding_at(double t) { return 4 * std::numeric_limits<double>::epsilon() * std::abs(t); }

}  // namespace

void GuardFinder::measure() {
  if (turn_parts_ > 0) return;
  const State &from = interval_.from(), &end = *end_;
  const double w = std::max(fastest_turn_at(dynamics_, from), fastest_turn_at(dynamics_, end));
  turn_parts_ = std::max(1.0, std::ceil((end.t - from.t) * w / (kEighth * kPi)));
  if (!std::isfinite(turn_parts_)) refuse();
  along_ = end.coordinates && end.coordinates->n_v() == 0 && interval_.has_dense();
}

void GuardFinder::refuse() const {
  const double t0 = interval_.from().t;
  throw StepError(fmt::format("a body rotates by {:.3g} rad in the step of {:.3g} s from t = {:.9g} s; events and "
                              "contacts are found up to {:.2g} rad; limit the step (--step)",
                              turn_parts_ * kEighth * kPi, end_->t - t0, t0, kMost * kEighth * kPi),
                  t0);
}

bool GuardFinder::find_and_cut(State& end) {
  if (guards_.empty()) return false;
  if (std::ranges::any_of(guards_, &Guard::inside) && must_look_closely()) {
    place_evenly(), sample();
    for (std::size_t k = 0; k < guards_.size(); ++k)
      if (guards_[k].inside) search(k);
  }
  search_outputs();
  const bool is_cut = first() < end.t;
  if (is_cut)
    interval_.cut(first(), end);
  else
    interval_.put_back_method();
  return is_cut;
}

// Where a body makes many parts, few instants show whether any guard comes nearer to zero than twice what it differs by.
bool GuardFinder::must_look_closely() {
  measure();
  place_sparsely();
  if (along_ || turn_parts_ <= kLeast || static_cast<double>(inside_.size()) >= turn_parts_) return true;
  sample();
  for (std::size_t k = 0; k < guards_.size(); ++k) {
    double least = kNever, low = kNever, high = -kNever;
    for (std::size_t j = 0; j < times_.size(); ++j) {
      const double g = seen(k, j).g;
      least = std::min(least, std::abs(g)), low = std::min(low, g), high = std::max(high, g);
    }
    if (guards_[k].inside && !(least > 2 * (high - low))) return true;
  }
  return false;
}

double GuardFinder::first() const {
  double at = kNever;
  for (const Guard& g : guards_) at = std::min(at, g.at);
  return at;
}

void GuardFinder::place_evenly() {
  const double t0 = interval_.from().t, h = end_->t - t0;
  if (!(turn_parts_ <= kMost)) refuse();
  const int n = std::max(along_ ? kAlong : kLeast, static_cast<int>(turn_parts_));
  inside_.clear();
  for (int k = 1; k < n; ++k) inside_.push_back(t0 + h * k / n);
}

// Down to a part from the start of the step, each by an eighth of its time before the next. A steady rotation
// makes half a revolution or more between some of them, whichever its speed.
void GuardFinder::place_sparsely() {
  const double t0 = interval_.from().t, h = end_->t - t0;
  inside_.clear();
  for (double x = 1 - kEighth; x * turn_parts_ > 1; x *= 1 - kEighth) inside_.push_back(t0 + h * x);
  std::ranges::reverse(inside_);
}

void GuardFinder::sample() {
  times_.assign(1, interval_.from().t), values_.clear();
  for (const Guard& g : guards_) values_.push_back(g.from);
  for (const double t : inside_) {
    times_.push_back(t);
    const Sample state(dynamics_, look(t), interval_.report());
    for (const Guard& g : guards_) values_.push_back(g.inside ? value(g, state) : g.from);
  }
  times_.push_back(end_->t);
  for (const Guard& g : guards_) values_.push_back(g.to);
}

// A state that is not the method's own may be where a guard has no value: there it counts as unchanged.
double GuardFinder::value(const Guard& g, const Sample& state) {
  if (interval_.has_dense()) return g.owner->guard(g.of, state);
  try {
    return g.owner->guard(g.of, state);
  } catch (const NonFiniteError&) {
    return g.from;
  } catch (const SolveError&) {
    return g.from;
  }
}

void GuardFinder::search(std::size_t k) {
  Guard& g = guards_[k];
  const std::size_t n = times_.size() - 1;
  search_end(g, seen(k, 0), seen(k, 1), seen(k, 2));
  for (std::size_t j = 1; j <= n && g.at > times_[j - 1]; ++j) {
    const Sampled a = seen(k, j - 1), b = seen(k, j);
    if (g.crosses(a.g, b.g))
      meet(g, a, b);
    else if (j < n)
      search_turn(g, a, b, seen(k, j + 1));
    else
      search_end(g, b, a, seen(k, n - 2));
  }
}

// About a turning point between an end of the step and the instant next to it, where the guard is nearest to zero at the
// end and goes towards it from there, in the least share of a part.
void GuardFinder::search_end(Guard& g, Sampled end, const Sampled& next, const Sampled& after) {
  const double sign = end.g > 0 ? 1 : -1;
  if (end.g == 0 || !(sign * next.g >= sign * end.g)) return;
  if (std::abs(end.g) > std::abs(next.g - end.g) + std::abs(after.g - next.g)) return;
  const Sampled beside = look_at(g, end.t + kLeastShare * (next.t - end.t));
  if (!(sign * beside.g < sign * end.g)) return;
  const bool at_start = end.t < next.t;
  search_turn(g, at_start ? end : next, beside, at_start ? next : end);
}

// About a turning point of three: of one side of zero, or the middle one beyond it.
void GuardFinder::search_turn(Guard& g, Sampled a, Sampled middle, Sampled b) {
  const double sign = a.g > 0 ? 1 : -1;
  if (!(sign * a.g > 0 && sign * b.g > 0 && sign * a.g >= sign * middle.g && sign * b.g >= sign * middle.g)) return;
  const double shortest = std::max(g.tolerance, rounding_at(b.t));
  if (sign * middle.g > 0 && !comes_to_zero(a, middle, b, shortest, [&](double t) { return look_at(g, t).g; })) return;
  if (g.crosses(a.g, middle.g))
    meet(g, a, middle);
  else if (g.crosses(middle.g, b.g))
    meet(g, middle, b);
}

void GuardFinder::meet(Guard& g, Sampled a, Sampled b) {
  if (!interval_.has_dense() && !of_method(g, a, b)) return;
  const double sign = a.g > 0 ? 1 : -1, rounding = rounding_at(b.t);
  const double t = falling_root(a.t, sign * a.g, b.t, sign * b.g, std::max(g.tolerance, rounding),
                                [&](double at) { return sign * own(g, at).g; });
  if (t > g.after) g.at = std::min(g.at, std::max(t, g.least));
}

// Moves the ends of a bracket onto states of the method; false if these do not cross.
bool GuardFinder::of_method(const Guard& g, Sampled& a, Sampled& b) {
  const Sampled start{interval_.from().t, g.from}, end{end_->t, g.to};
  if (a.t != start.t) a = own(g, a.t);
  if (b.t != end.t) b = own(g, b.t);
  if (g.crosses(a.g, b.g)) return true;
  a = start;
  if (g.crosses(a.g, b.g)) return true;
  b = end;
  return g.crosses(a.g, b.g);
}

// What is seen at an output before the first guard is met in this step, so that no row lies beyond one that is not.
void GuardFinder::search_outputs() {
  if (!interval_.has_dense() || !(clock_.next_output() < first_before_end())) return;
  const auto looking = uncounted(dynamics_);
  before_.clear();
  for (const Guard& g : guards_) before_.push_back(g.from);
  double last = interval_.from().t;
  long n = 0;
  for (double t = clock_.next_output(); t < first_before_end(); t = clock_.output_ahead(++n)) {
    if (!(t > last)) continue;
    const Sample state(dynamics_, look(t), interval_.report());
    here_.clear();
    for (const Guard& g : guards_) here_.push_back(g.owner->guard(g.of, state));
    for (std::size_t k = 0; k < guards_.size(); ++k)
      if (Guard& g = guards_[k]; g.crosses(before_[k], here_[k])) meet(g, {last, before_[k]}, {t, here_[k]});
    before_.swap(here_), last = t;
  }
}

// q by the cubic with the rates at both ends. States of other coordinates at the end have none.
void GuardFinder::fit() {
  const State& from = interval_.from();
  keep_state(from, guess_);
  if (from.q.size() > 0) kinematic_rate(from, rate0_), kinematic_rate(*end_, rate1_);
  fits_ = true;
}

// On the constraints by dense output; or of a method without it near them: a cubic in q and a line in v and s between
// the ends.
const State& GuardFinder::look(double t) {
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
