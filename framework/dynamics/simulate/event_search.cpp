// Where the conditions of events are met inside a step: at sign changes between the instants of the look (StepSearch),
// about turning points towards zero beside them, and at outputs, none of which may lie beyond an event that was not
// met.
#include <algorithm>
#include <cmath>
#include <utility>

#include <lockstep/error.h>
#include "framework/dynamics/simulate/event_locator.h"

namespace lockstep {

namespace {

constexpr double kBeside =
    1.0 / 1024;  // of a part: how near to the ends of a step it is seen which way a condition goes

}  // namespace

void EventLocator::search(const State& end) {
  kept_ = false;
  search_.begin(end);
  if (!rule_out(end)) {
    sample(end, search_.even());
    for (std::size_t k = 0; k < searched_.size(); ++k) search_parts(k);
  }
  search_outputs(end);
}

void EventLocator::sample(const State& end, const std::vector<double>& inside) {
  times_.assign(1, interval_.from().t), values_.clear();
  for (const std::size_t i : searched_) values_.push_back(watched_[i].value);
  for (const double t : inside) {
    times_.push_back(t);
    const State& state = search_.look(t);
    for (const std::size_t i : searched_) values_.push_back(value_inside(i, state));
  }
  times_.push_back(end.t);
  for (const std::size_t i : searched_) values_.push_back(watched_[i].now);
}

// A state that is not the method's own may be where a condition has no value: there it counts as unchanged.
double EventLocator::value_inside(std::size_t i, const State& state) {
  if (interval_.has_dense()) return value_of(i, state);
  try {
    return value_of(i, state);
  } catch (const NonFiniteError&) {
    return watched_[i].value;
  } catch (const SolveError&) {
    return watched_[i].value;
  }
}

// Of many parts few instants show whether any condition comes near zero at all.
bool EventLocator::rule_out(const State& end) {
  if (!search_.many()) return false;
  sample(end, search_.scales());
  for (std::size_t k = 0; k < searched_.size(); ++k) {
    double least = kNever, low = kNever, high = -kNever;
    for (std::size_t j = 0; j < times_.size(); ++j) {
      const double g = sampled(k, j).g;
      least = std::min(least, std::abs(g)), low = std::min(low, g), high = std::max(high, g);
    }
    if (!is_far(least, high - low)) return false;
  }
  return true;
}

void EventLocator::search_parts(std::size_t k) {
  const std::size_t i = searched_[k], n = times_.size() - 1;
  search_end(i, sampled(k, 0), sampled(k, 1), sampled(k, 2));
  for (std::size_t j = 1; j <= n && watched_[i].at > times_[j - 1]; ++j) {
    const Sampled a = sampled(k, j - 1), b = sampled(k, j);
    if (crosses(i, a.g, b.g))
      meet(i, a, b);
    else if (j < n)
      search_turn(i, a, b, sampled(k, j + 1));
    else
      search_end(i, b, a, sampled(k, n - 2));
  }
}

// About a turning point between an end of the step and the instant next to it, where the condition is nearest to zero
// at the end and goes towards it from there.
void EventLocator::search_end(std::size_t i, Sampled end, const Sampled& next, const Sampled& after) {
  const double sign = end.g > 0 ? 1 : -1;
  if (end.g == 0 || !(sign * next.g >= sign * end.g)) return;
  if (std::abs(end.g) > std::abs(next.g - end.g) + std::abs(after.g - next.g)) return;
  const Sampled beside = look(i, end.t + kBeside * (next.t - end.t));
  if (!(sign * beside.g < sign * end.g)) return;
  const bool at_start = end.t < next.t;
  search_turn(i, at_start ? end : next, beside, at_start ? next : end);
}

// About a turning point of three: of one side of zero, or the middle one beyond it.
void EventLocator::search_turn(std::size_t i, Sampled a, Sampled middle, Sampled b) {
  const double sign = a.g > 0 ? 1 : -1;
  if (!(sign * a.g > 0 && sign * b.g > 0 && sign * a.g >= sign * middle.g && sign * b.g >= sign * middle.g)) return;
  const double shortest = std::max(events_[i].tolerance, 4 * std::numeric_limits<double>::epsilon() * std::abs(b.t));
  if (sign * middle.g > 0 && !comes_to_zero(a, middle, b, shortest, [&](double t) { return look(i, t).g; })) return;
  if (crosses(i, a.g, middle.g))
    meet(i, a, middle);
  else if (crosses(i, middle.g, b.g))
    meet(i, middle, b);
}

// The event is met between a and b. The same instant again does not count. Where the states looked at are not those of
// the method its own decide.
void EventLocator::meet(std::size_t i, const Sampled& a, const Sampled& b) {
  Watched& w = watched_[i];
  std::pair<Sampled, Sampled> ends{a, b};
  if (!interval_.has_dense() && !of_method(i, ends)) return;
  const double t = root_between(i, ends.first, ends.second);
  if (t - w.last > 2 * events_[i].tolerance) w.at = std::min(w.at, t);
}

// Moves the ends of a bracket onto states of the method; false where these do not cross.
bool EventLocator::of_method(std::size_t i, std::pair<Sampled, Sampled>& ends) {
  const Sampled start{times_.front(), watched_[i].value}, end{times_.back(), watched_[i].now};
  if (!kept_) interval_.keep_method();
  kept_ = true;
  auto& [a, b] = ends;
  a = a.t == start.t ? start : point(i, a.t);
  b = b.t == end.t ? end : point(i, b.t);
  if (crosses(i, a.g, b.g)) return true;
  a = start;
  if (crosses(i, a.g, b.g)) return true;
  b = end;
  return crosses(i, a.g, b.g);
}

// What is seen at an output before the first event is met in this step, so that no row lies beyond one that is not.
void EventLocator::search_outputs(const State& end) {
  const auto first = [&] {
    double at = end.t;
    for (const std::size_t i : searched_) at = std::min(at, watched_[i].at);
    return at;
  };
  const std::vector<double>& outputs = search_.outputs_before(first());
  if (outputs.empty()) return;
  const Dynamics::Aside aside(dynamics_);
  before_.clear();
  for (const std::size_t i : searched_) before_.push_back({interval_.from().t, watched_[i].value});
  for (const double t : outputs) {
    if (!(t < first())) return;
    here_.clear();
    const State& state = search_.look(t);
    for (const std::size_t i : searched_) here_.push_back({t, value_of(i, state)});
    for (std::size_t k = 0; k < searched_.size(); ++k)
      if (crosses(searched_[k], before_[k].g, here_[k].g)) meet(searched_[k], before_[k], here_[k]);
    before_.swap(here_);
  }
}

}  // namespace lockstep
