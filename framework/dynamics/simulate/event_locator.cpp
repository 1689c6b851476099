// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/simulate/event_locator.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/dynamics/simulate/user_code.h"

namespace lockstep {

namespace {

// Whether the condition's value is on the side to which a crossing in one sense leads.
bool is_past(Event::Crossing crossing, double value) {
  return crossing == Event::Crossing::rising ? value > 0 : crossing == Event::Crossing::falling && value < 0;
}

const Lock* link_named(const System& system, const std::string& name) {
  for (const auto& link : system.links())
    if (link->name() == name) return link.get();
  return nullptr;
}

// `events`: other objects that the name may refer to.
[[noreturn]] void refuse_unknown(const System& system, const std::string& name, const std::string& who,
                                 const std::deque<Event>& events) {
  std::vector<std::string> names;
  for (const auto& link : system.links()) names.push_back(link->name());
  for (const auto& force : system.forces()) names.push_back(force->name());
  for (const Event& event : events) names.push_back(event.name);
  throw ModelError(fmt::format("{}: unknown {} \"{}\"{}", who,
                               events.empty() ? "joint or force" : "joint, force or event", name,
                               text::suggestion(name, names)));
}

}  // namespace

const Force* force_named(const System& system, const std::string& name) {
  for (const auto& force : system.forces())
    if (force->name() == name) return force.get();
  return nullptr;
}

Event& EventLocator::add(Event event) {
  if (!event.value && !(event.at >= 0))
    throw ModelError(
        fmt::format("event '{}' has neither a time (at >= 0) nor a condition (value); give one", event.name));
  if (event.value && event.at >= 0)
    throw ModelError(fmt::format(
        "event '{}' has a time (at {} s) and a condition (value); give one, and make a second event for the other",
        event.name, event.at));
  if (!(event.tolerance > 0))
    throw ModelError(
        fmt::format("event '{}': its tolerance of {} s must be greater than 0", event.name, event.tolerance));
  check_switched(event, "event '" + event.name + "'");
  events_.push_back(std::move(event));
  return events_.back();
}

void EventLocator::check_switched(const Event& event, const std::string& who) const {
  const System& system = dynamics_.system();
  for (const std::vector<std::string>* names : {&event.activate, &event.deactivate})
    for (const std::string& name : *names)
      if (const Force* force = force_named(system, name)) {
        if (force->switch_memory() < 0)
          throw ModelError(fmt::format(
              "{}: force '{}' cannot be switched; call its set_switched() before the system is set up", who, name));
      } else if (const Lock* link = link_named(system, name); link == nullptr)
        refuse_unknown(system, name, who, {});
      else if (system.merged(*link))
        throw ModelError(
            fmt::format("{}: joint '{}' is merged into one rigid group and cannot be switched; exclude it, as in "
                        "set_merge(true, {{&joint}})",
                        who, name));
}

bool EventLocator::turn(const std::string& name, bool on) {
  const System& system = dynamics_.system();
  if (link_named(system, name) != nullptr || force_named(system, name) != nullptr) return false;
  bool found = false;
  for (Event& event : events_)
    if (event.name == name) event.on = on, found = true;
  if (!found) refuse_unknown(system, name, "a call", events_);
  return true;
}

void EventLocator::join(const State& state) try {
  watched_.push_back({});
  watch(state);
} catch (...) {
  events_.pop_back(), watched_.pop_back();
  throw;
}

void EventLocator::start(double t) {
  watched_.assign(events_.size(), {});
  left_zero_.clear();
  for (std::size_t i = 0; i < events_.size(); ++i) watched_[i].over = !events_[i].value && events_[i].at < t;
}

double EventLocator::next_instant(double t) const {
  double next = kNever;
  for (std::size_t i = 0; i < events_.size(); ++i)
    if (!events_[i].value && events_[i].on && !watched_[i].over && events_[i].at > t)
      next = std::min(next, events_[i].at);
  return next;
}

void EventLocator::watch(const State& state) {
  for (std::size_t i = 0; i < events_.size(); ++i) {
    watched_[i].off = !events_[i].on;
    if (events_[i].value && events_[i].on && !watched_[i].over) watched_[i].value = value_of(i, state);
  }
}

double EventLocator::guard(std::size_t event, const Sample& sample) {
  const std::string& name = events_[event].name;
  const double t = sample.state.t;
  const double g = user_code("event", name, t, [&] { return events_[event].value(sample); });
  if (std::isfinite(g)) return g;
  throw NonFiniteError(
      fmt::format("the condition of event '{}' is {} at t = {:.9g} s; it must be a finite number", name, g, t), t);
}

double EventLocator::value_of(std::size_t event, const State& state) {
  return guard(event, Sample(dynamics_, state, interval_.report()));
}

void EventLocator::add_guards(const State& end) {
  for (std::size_t i = 0; i < events_.size(); ++i) {
    Watched& w = watched_[i];
    const Event& e = events_[i];
    w.met = false;
    w.off = w.off || !e.on;
    if (!e.value || w.over || !e.on) continue;
    if (w.off) w.value = value_of(i, interval_.from()), w.off = false;
    if (const auto* shown = e.value.target<ChannelCondition>(); shown != nullptr && shown->memory) {
      const Sample at_end(dynamics_, end, interval_.report());
      user_code("event", e.name, end.t, [&] { shown->memory->inside(LastStep(dynamics_, interval_, at_end, kNever)); });
    }
    finder_.add({.owner = this,
                 .of = i,
                 .crossing = e.crossing,
                 .tolerance = e.tolerance,
                 .after = w.last + 2 * e.tolerance,  // the same instant again does not count
                 .from = w.value,
                 .to = value_of(i, end)});
  }
}

bool EventLocator::meet(const State& end, bool is_cut) {
  bool met = false;
  for (std::size_t k = 0; k < finder_.guards().size(); ++k) {
    Guard& g = finder_.guards()[k];
    if (g.owner != this) continue;
    Watched& w = watched_[g.of];
    if (is_cut) g.to = value_of(g.of, end);
    w.met = reaches(g.at, end.t) || (is_cut && end.t > g.after && g.crosses(g.from, g.to));
    met = met || w.met;
    note_nearest(k, end.t);
    note_left_zero(g);
    w.value = g.to;
  }
  for (Watched& w : watched_) w.first = false;
  return met;
}

void EventLocator::pass(double t) {
  for (std::size_t i = 0; i < events_.size(); ++i)
    watched_[i].over = watched_[i].over || (!events_[i].on && !events_[i].value && events_[i].at <= t);
}

// Of what was seen up to t, where the step ends.
void EventLocator::note_nearest(std::size_t k, double t) {
  Sampled &nearest = watched_[finder_.guards()[k].of].nearest, before{t, 0};
  const auto see = [&](const Sampled& s) {
    if (before.g * s.g < 0 && nearest.g != 0)  // the way that does not count
      nearest = {before.t + (s.t - before.t) * before.g / (before.g - s.g), 0};
    if (std::abs(s.g) < std::abs(nearest.g)) nearest = s;
    before = s;
  };
  for (std::size_t j = 0; j < finder_.n_seen() && finder_.seen(k, j).t < t; ++j) see(finder_.seen(k, j));
  see({t, finder_.guards()[k].to});
}

std::vector<EventCourse> EventLocator::courses() const {
  std::vector<EventCourse> all;
  for (std::size_t i = 0; i < events_.size(); ++i) {
    const Watched w = i < watched_.size() ? watched_[i] : Watched{};
    all.push_back({.name = events_[i].name, .last = w.last});
    if (w.nearest.t != kNever) all.back().nearest = w.nearest.g, all.back().at = w.nearest.t;
  }
  return all;
}

// Only the first step shows it: zero is on no side.
void EventLocator::note_left_zero(const Guard& g) {
  const bool either = g.crossing == Event::Crossing::any;
  if (watched_[g.of].first && g.from == 0 && (either || is_past(g.crossing, g.to)))
    left_zero_.push_back(events_[g.of].name);
}

bool EventLocator::by_time(std::size_t i, double t) const {
  return events_[i].on && !events_[i].value && !watched_[i].over && reaches(events_[i].at, t);
}

const std::vector<std::size_t>& EventLocator::due(double t) {
  due_.clear();
  for (std::size_t i = 0; i < events_.size(); ++i)
    if (by_time(i, t) || (events_[i].on && watched_[i].met)) due_.push_back(i);
  return due_;
}

bool EventLocator::any_due(double t) const {
  for (std::size_t i = 0; i < events_.size(); ++i)
    if (by_time(i, t)) return true;
  return false;
}

void EventLocator::forget_met() {
  for (Watched& w : watched_) w.met = false;
}

void EventLocator::done(std::size_t i, double t) {
  Watched& w = watched_[i];
  w.met = false;
  w.last = t;
  w.over = events_[i].once || !events_[i].value;
}

std::vector<std::string> EventLocator::take_left_zero() { return std::exchange(left_zero_, {}); }

std::vector<std::string> EventLocator::past_at_start() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < events_.size(); ++i)
    if (events_[i].value && is_past(events_[i].crossing, watched_[i].value)) names.push_back(events_[i].name);
  return names;
}

void EventLocator::save(Snapshot& out) const {
  out.put(static_cast<double>(events_.size()));
  for (std::size_t i = 0; i < events_.size(); ++i) {
    const Watched& w = watched_[i];
    out.put_text(events_[i].name);
    for (const double x : {w.value, w.last, w.nearest.t, w.nearest.g}) out.put(x);
    for (const bool flag : {w.over, w.first, w.met, events_[i].on, w.off}) out.put(flag ? 1 : 0);
  }
}

void EventLocator::load(SnapshotReader& in) {
  const long n = in.get_count();
  if (n != static_cast<long>(events_.size()))
    throw ModelError(fmt::format("the run was saved with {} events and has {}; add the same events before load()", n,
                                 events_.size()));
  std::vector<Watched> watched(events_.size());
  std::vector<bool> on(events_.size());
  for (std::size_t i = 0; i < events_.size(); ++i) {
    Watched& w = watched[i];
    if (const std::string name = in.get_text(); name != events_[i].name)
      throw ModelError(fmt::format(
          "the run was saved with event '{}' and has '{}' in its place; add the same events in the same order", name,
          events_[i].name));
    for (double* x : {&w.value, &w.last, &w.nearest.t, &w.nearest.g}) *x = in.get();
    w.over = in.get_flag(), w.first = in.get_flag(), w.met = in.get_flag();
    on[i] = in.get_flag(), w.off = in.get_flag();
  }
  watched_ = std::move(watched);
  for (std::size_t i = 0; i < events_.size(); ++i) events_[i].on = on[i];
}

}  // namespace lockstep
