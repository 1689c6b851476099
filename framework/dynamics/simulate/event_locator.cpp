#include "framework/dynamics/simulate/event_locator.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/dynamics/simulate/root_finder.h"
#include <lockstep/error.h>

namespace lockstep {

Event& EventLocator::add(Event event) {
  if (!event.value && !(event.at >= 0))
    throw ModelError(
        fmt::format("event '{}' has neither an instant (at >= 0) nor a condition (value); give one", event.name));
  if (!(event.tolerance > 0))
    throw ModelError(fmt::format("event '{}': its tolerance of {} s must be > 0", event.name, event.tolerance));
  const System& system = dynamics_.system();
  for (const std::vector<std::string>* names : {&event.activate, &event.deactivate})
    for (const std::string& name : *names)
      if (system.merged(system.link(name)))
        throw ModelError(
            fmt::format("event '{}': link '{}' is merged into one slot and cannot be switched; keep it, as in "
                        "set_merge(true, {{&link}})",
                        event.name, name));
  events_.push_back(std::move(event));
  return events_.back();
}

void EventLocator::join(const State& state) {
  watched_.push_back({});
  watched_.back().over = !events_.back().value && events_.back().at < state.t;
  watch(state);
}

void EventLocator::start(double t) {
  watched_.assign(events_.size(), {});
  for (std::size_t i = 0; i < events_.size(); ++i) watched_[i].over = !events_[i].value && events_[i].at < t;
}

double EventLocator::next_instant(double t) const {
  double next = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < events_.size(); ++i)
    if (!events_[i].value && !watched_[i].over && events_[i].at > t) next = std::min(next, events_[i].at);
  return next;
}

void EventLocator::watch(const State& state) {
  for (std::size_t i = 0; i < events_.size(); ++i)
    if (events_[i].value && !watched_[i].over) watched_[i].value = value_of(i, state);
}

double EventLocator::value_of(std::size_t event, const State& state) {
  const double g = events_[event].value(Sample(dynamics_, state, interval_.report()));
  if (std::isfinite(g)) return g;
  throw NonFiniteError(fmt::format("the condition of event '{}' is {} at t = {:.9g} s; it must be a finite number",
                                   events_[event].name, g, state.t),
                       state.t);
}

// Strictly from one side: a condition that is zero at the start of a step is not crossed in it.
bool EventLocator::crosses(std::size_t event, double now) const {
  const double was = watched_[event].value;
  const bool rises = was < 0 && now >= 0, falls = was > 0 && now <= 0;
  switch (events_[event].crossing) {
    case Event::Crossing::rising:
      return rises;
    case Event::Crossing::falling:
      return falls;
    default:
      return rises || falls;
  }
}

double EventLocator::locate_crossing(std::size_t event, double t1) {
  const Watched& w = watched_[event];
  const double sign = w.value > 0 ? 1 : -1;
  const double tolerance =
      std::max(events_[event].tolerance, 4 * std::numeric_limits<double>::epsilon() * std::abs(t1));
  return falling_root(interval_.from().t, sign * w.value, t1, sign * w.now, tolerance, 0.0,
                      [&](double t) { return sign * value_of(event, interval_.at(t)); });
}

bool EventLocator::locate(State& state) {
  const double t1 = state.t;
  double first = std::numeric_limits<double>::infinity();
  bool crossed = false;
  for (std::size_t i = 0; i < events_.size(); ++i) {
    Watched& w = watched_[i];
    w.met = false;
    if (!events_[i].value || w.over) continue;
    w.now = value_of(i, state);
    if (!crosses(i, w.now)) continue;
    if (!crossed) interval_.keep_method();
    crossed = true;
    w.at = locate_crossing(i, t1);
    w.met = w.at - w.last > 2 * events_[i].tolerance;  // the same instant again does not count
    if (w.met) first = std::min(first, w.at);
  }
  if (std::isfinite(first) && first < t1) {
    interval_.cut(first, state);
    for (std::size_t i = 0; i < events_.size(); ++i) {
      Watched& w = watched_[i];
      if (!events_[i].value || w.over) continue;
      const double g = value_of(i, state);
      w.met = w.met && (w.at <= first || crosses(i, g));
      w.now = g;
    }
  } else if (crossed) {
    interval_.restore_method();
  }
  for (Watched& w : watched_) w.value = w.now;
  return std::isfinite(first);
}

EventLocator::Due EventLocator::take(std::size_t i, double t) {
  const Event& event = events_[i];
  Watched& w = watched_[i];
  const bool met = w.met;
  if (!(event.value ? met : !w.over && event.at <= t)) return Due::no;
  w.met = false;
  w.last = t;
  w.over = event.once || !event.value;
  return met ? Due::by_condition : Due::by_time;
}

}  // namespace lockstep
