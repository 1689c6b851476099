// SPDX-License-Identifier: BSD-3-Clause
// What changes the state between two steps: events, and the links that come into force by them or by contact.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>

#include <lockstep/error.h>
#include "framework/dynamics/simulate/consistency.h"
#include "framework/dynamics/simulate/decided_rows.h"
#include "framework/dynamics/simulate/keep_state.h"
#include "framework/dynamics/simulate/step_loop_parts.h"

namespace lockstep {

namespace {

// Of the events that are due at t none may undo what another does: their order would decide.
void refuse_contradictions(const EventLocator& events, const std::vector<std::size_t>& due, double t) {
  for (const std::size_t on : due)
    for (const std::size_t off : due)
      for (const std::string& name : events[on].activate)
        if (std::ranges::find(events[off].deactivate, name) != events[off].deactivate.end())
          throw ModelError(
              {.thing = {.kind = "event", .name = events[on].name},
               .problem = fmt::format("it activates '{}' at t = {:.9g} s, and event '{}' deactivates it at the same "
                                      "time; remove '{}' from one of them, or let one happen later",
                                      name, t, events[off].name, name)});
}

// What a change may not touch: the sizes of the state, its time, and what is in force. `before`: the state that the
// change was given.
void check_change(const System& system, const Event& e, const State& before, const State& after) {
  const auto refuse = [&](const std::string& what) {
    throw ModelError(fmt::format(
        "event '{}': its change {}; only coordinates, velocities and integrated states may change", e.name, what));
  };
  if (after.t != before.t) refuse(fmt::format("set the time from {:.9g} s to {:.9g} s", before.t, after.t));
  const std::tuple<const char*, std::ptrdiff_t, std::ptrdiff_t> sizes[] = {
      {"coordinates", before.q.size(), after.q.size()},
      {"velocities", before.v.size(), after.v.size()},
      {"integrated states", before.s.size(), after.s.size()},
      {"remembered numbers", before.z.size(), after.z.size()},
      {"joints", std::ssize(before.modes), std::ssize(after.modes)},
      {"joints", std::ssize(before.watched), std::ssize(after.watched)}};
  for (const auto& [what, was, is] : sizes)
    if (was != is) refuse(fmt::format("at t = {:.9g} s left {} {} instead of {}", before.t, is, what, was));
  const auto switched = [&](const std::string& thing) {
    refuse(fmt::format("switched {} at t = {:.9g} s, which only its lists may do (activate, deactivate)", thing,
                       before.t));
  };
  for (const auto& link : system.links())
    if (const auto k = static_cast<std::size_t>(link->number());
        after.modes[k] != before.modes[k] || after.watched[k] != before.watched[k])
      switched("joint '" + link->name() + "'");
  for (const auto& force : system.forces())
    if (const int k = force->switch_memory(); k >= 0 && after.z[k] != before.z[k])
      switched("force '" + force->name() + "'");
}

}  // namespace

// What is due at the present time acts before the next step.
void StepLoop::settle_now() {
  parts_->fall_due(Due::before_jump);
  deliver();
}

void StepLoop::activate(const std::string& name) {
  if (!parts_->events.turn(name, true)) switch_now("activate", {.name = {}, .activate = {name}});
}

void StepLoop::deactivate(const std::string& name) {
  if (!parts_->events.turn(name, false)) switch_now("deactivate", {.name = {}, .deactivate = {name}});
}

// All of the change or nothing, as of an event; a call that fails is not made again.
void StepLoop::switch_now(const char* call, const Event& change) {
  dynamics_.set_up();
  parts_->events.check_switched(change, "a call");
  exclusively(call, [&] {
    aim_at(kNever);
    keeps_stop_ = true;
    start(false);
    const AtEnd switched([this] {
      if (std::exchange(parts_->by_call, nullptr) != nullptr && parts_->due.what <= Due::events) parts_->due = {};
    });
    parts_->by_call = &change;
    settle_now();
    parts_->interval.note_acting(state_);
  });
}

// Fires the events that are due at the present state: all of a time or none.
void StepLoop::fire_events() {
  EventLocator& events = parts_->events;
  const std::vector<std::size_t>& due = events.due(state_.t);
  if (due.empty() && parts_->by_call == nullptr) return;
  const bool changed = parts_->or_as_before(state_, [&] { return apply_events(due); });
  bool cut = false;
  for (const std::size_t i : due) {
    cut = cut || events[i].value;
    if (events[i].stop) {
      report_.stopped = true;
      report_.stopped_by += (report_.stopped_by.empty() ? "" : ", ") + events[i].name;
    }
    events.done(i, state_.t);
  }
  parts_->change.acted = parts_->change.acted || changed;
  parts_->by_call = nullptr;
  if (changed || cut) begin_method();
}

// Returns whether any changed the state.
bool StepLoop::apply_events(const std::vector<std::size_t>& due) {
  const EventLocator& events = parts_->events;
  refuse_contradictions(events, due, state_.t);
  std::string names;
  const auto act = [&](const Event& e, const std::string& who, const std::string& next) {
    if (!changes_state(e)) return;
    parts_->to_slots(dynamics_, state_);
    apply(e, who);
    names += names.empty() ? who : next;
  };
  for (const std::size_t i : due) act(events[i], "event '" + events[i].name + "'", ", '" + events[i].name + "'");
  if (parts_->by_call != nullptr) act(*parts_->by_call, "a call", " and a call");
  if (names.empty()) return false;
  make_consistent(names);
  std::string& cause = parts_->change.cause;
  cause += (cause.empty() ? "" : " and ") + names;
  return true;
}

void StepLoop::apply(const Event& e, const std::string& who) {
  refuse_switch_of_decided(system(), state_.modes, e, who);
  std::vector<std::string> engaged;
  const auto put = [&](const std::string& name, bool on) {  // a unilateral link comes into force at contact
    if (const Force* force = force_named(system(), name)) {
      state_.z[force->switch_memory()] = on ? 1 : 0;
      return;
    }
    if (on) engaged.push_back(name);
    const Lock& link = system().link(name);
    const auto number = static_cast<std::size_t>(link.number());
    state_.modes[number] = on && !link.unilateral();
    state_.watched[number] = on && link.unilateral();
  };
  for (const std::string& name : e.activate) put(name, true);
  for (const std::string& name : e.deactivate) put(name, false);
  if (e.change) {
    const State before = state_;
    user_code("event", e.name, before.t, [&] { e.change(state_); });
    check_change(system(), e, before, state_);
  }
  if (!state_.q.allFinite() || !state_.v.allFinite() || !state_.s.allFinite())
    throw NonFiniteError(fmt::format("{} made the state not finite at t = {:.9g} s", who, state_.t), state_.t);
  dynamics_.normalize(state_);
  engage_links(dynamics_, state_, engaged);
  check_links(dynamics_, state_, engaged, who, options_.start_limit);
  parts_->contacts.check_sides(state_, engaged, who + " at t = " + fmt::format("{:.9g}", state_.t) + " s");
}

// Impacts are those of the bodies; if nothing changes, the state is what it was.
void StepLoop::settle_contacts() {
  const ContactManager::Settled settled = parts_->or_as_before(state_, [&] {
    parts_->to_slots(dynamics_, state_);
    return parts_->contacts.settle(state_);
  });
  parts_->clock.last().touch(settled.touched);
  if (!settled.restart) keep_state(parts_->kept, state_);
  if (settled.impact) ++report_.impacts;
  if (!settled.resting.empty()) make_consistent(settled.resting);
  if (settled.impact) dynamics_.accept(state_);  // what is remembered may depend on speeds
  if (settled.restart) begin_method();
}

void StepLoop::make_consistent(const std::string& cause) {
  lockstep::make_consistent(dynamics_, state_, cause, options_.start_limit);
  if (!parts_->events.empty()) parts_->events.watch(state_);
}

}  // namespace lockstep
