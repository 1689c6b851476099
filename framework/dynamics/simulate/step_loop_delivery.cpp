// SPDX-License-Identifier: BSD-3-Clause
// What a step loop hands over: calls of observers and progress, changes at the end of a step, warnings.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include <lockstep/error.h>
#include "framework/dynamics/evaluate/speed_of.h"
#include "framework/dynamics/integrate/culprit.h"
#include "framework/dynamics/simulate/step_loop_parts.h"
#include "framework/dynamics/simulate/step_rules.h"
#include "framework/dynamics/tree/joint_tree.h"
#include "framework/dynamics/tree/slender_bodies.h"
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/foundation/support/thrown.h"

namespace lockstep {

std::vector<EventCourse> StepLoop::event_courses() const { return parts_->events.courses(); }

namespace {

// Makes this call of all observers that were not called yet. One that throws was called, unless it keeps rows and this
// makes one.
template <class Call>
void tell(const std::vector<Observer*>& observers, Delivery& now, double t, const Call& call) {
  while (now.called < observers.size()) {
    const std::size_t number = now.called++;
    Observer& o = *observers[number];
    try {
      call(o);
    } catch (...) {
      if (now.what != Due::step && o.keeps_rows()) now.called = number;
      rethrow_of_observer(o, number, t);
    }
  }
}

// The body that keeps steps short in joint coordinates in any state; "" if there is none.
std::string below_rounding(const System& system, const State& state, double tolerance) {
  const auto* tree = dynamic_cast<const JointTree*>(state.coordinates.get());
  const std::string body = tree == nullptr ? "" : slender_body(*tree, system, slenderness_at(tolerance));
  if (body.empty()) return {};
  return fmt::format(
      "; the tolerance of {:g} is below the round-off in joint coordinates: {}; use formulation omega, or a larger "
      "tolerance",
      tolerance, body);
}

}  // namespace

void StepLoop::deliver() { deliver(Sample(dynamics_, state_, parts_->interval.report())); }

void StepLoop::deliver(const Sample& sample) {
  for (Delivery& due = parts_->due; due.what != Due::nothing; due.go_on()) hand_over(due, sample);
}

void StepLoop::hand_over(Delivery& now, const Sample& sample) {
  Parts& p = *parts_;
  switch (now.what) {
    case Due::inside: {
      const LastStep step(dynamics_, p.interval, sample, p.clock.next_output(), options_.output, &p.along_laws);
      return tell(observers_, now, state_.t, [&](Observer& o) { o.inside(step); });
    }
    case Due::rows:
      return output_inside(now);
    case Due::step:
      return tell(observers_, now, state_.t, [&](Observer& o) { o.step(sample); });
    case Due::row:
      if (p.clock.output_due(state_.t)) output(now, sample);
      return;
    case Due::progress:
      if (now.called++ > 0 || !progress || function_code("progress", progress, state_.t, state_)) return;
      report_.stopped = true;
      report_.stopped_by = "the caller";
      return;
    case Due::before_jump:
      if (!p.acts(state_.t)) return;
      return tell(observers_, now, state_.t, [&](Observer& o) { o.before_jump(sample); });
    case Due::jump:
      if (!p.change.jump) return;
      if (p.change.refusal) throw AssemblyError(*p.change.refusal);
      make_consistent("the jump of a law");
      return to_coordinates(p.before_change);
    case Due::events:
      return fire_events();
    case Due::contacts:
      if (p.contacts.empty()) return;
      if (p.change.acted) settle_contacts();
      return p.contacts.note(state_, p.change.acted);
    case Due::jumped: {
      if (!p.change.acted) return;
      p.along_laws.reset();
      Sample after(dynamics_, state_, p.interval.report());
      after.cause = p.change.cause;
      return tell(observers_, now, state_.t, [&](Observer& o) { o.jumped(after); });
    }
    case Due::only_row:
      return output(now, sample);
    case Due::nothing:
      return;
  }
}

// A call that continues makes the states again from the step.
void StepLoop::output_inside(Delivery& now) {
  Clock& clock = parts_->clock;
  StepInterval& interval = parts_->interval;
  const double t0 = interval.from().t;
  for (; clock.next_output() < state_.t; now.called = 0)
    if (const double t = clock.next_output(); t > t0 && interval.has_dense())
      output(now, Sample(dynamics_, interval.at(t), interval.report()));
    else
      clock.pass_output();
}

void StepLoop::output(Delivery& now, const Sample& sample) {
  const double t = sample.state.t;
  tell(observers_, now, t, [&](Observer& o) { o.output(sample); });
  parts_->clock.note_output(t);
}

// Links and forces are compared over ten steps. In long steps all of them change.
std::string StepLoop::Parts::why_steps_end(Dynamics& dynamics, const State& state, double tolerance) const {
  constexpr double kLongStep = 1e-3;
  if (const std::string links = contacts.who_was_touched(clock.last()); !links.empty()) return "; " + links;
  State slots = state;
  dynamics.to_slots(slots);
  if (clock.advised() * speed_of(slots.v, dynamics.system().length()) > kLongStep)
    return "; the motion needs steps of this length: end the run earlier (until)";
  const std::string varies =
      who_varies(dynamics, state, std::max(10 * clock.advised(), kNegligible * std::max(1.0, std::abs(state.t))));
  return below_rounding(dynamics.system(), state, tolerance) + (varies.empty() ? "" : "; " + varies);
}

bool StepLoop::Parts::acts(double t) {
  return by_call != nullptr || !change.cause.empty() ||
         std::ranges::any_of(events.due(t), [&](std::size_t i) { return changes_state(events[i]); });
}

void StepLoop::output_end() {
  if (parts_->clock.end_due(state_.t)) parts_->fall_due(Due::only_row), deliver();
}

std::exception_ptr StepLoop::finish() {
  std::exception_ptr first;
  const Sample sample(dynamics_, state_, parts_->interval.report());
  for (std::size_t i = 0; i < parts_->started; ++i) {
    const auto finished = [&] { observer_code(*observers_[i], i, state_.t, [&] { observers_[i]->finish(sample); }); };
    if (const std::exception_ptr error = thrown_by(finished); !first) first = error;
  }
  return first;
}

// Methods that control their error account for rotation; implicit ones only in their Newton steps.
void StepLoop::measure_turns(double h, const Sample& sample) {
  if (const IntegratorInfo& method = parts_->interval.method(); method.adaptive && !method.implicit) return;
  const Inputs& in = sample.inputs();
  double most = 0;  // rad^2/s^2
  int fastest = 0;
  for (int k = 0; k < system().n_slots(); ++k)
    if (const double w2 = in.slot(k).w.squaredNorm(); w2 > most) most = w2, fastest = k;
  if (const double turn = h * std::sqrt(most); turn > report_.largest_turn && std::isfinite(turn))
    report_.largest_turn = turn, report_.turned_most = system().body_of_slot(fastest).name;
}

void StepLoop::warn_of_turns() {
  if (!(report_.largest_turn > kLongTurn) || warned_of_turns_) return;
  warned_of_turns_ = true;
  const char* next = method_->info().adaptive ? "limit the step (--step)"
                                              : "use a smaller step (--step), or a method with step control, "
                                                "such as dopri5 (--integrator dopri5)";
  add_finding(
      {&finding::long_turn, "body '" + report_.turned_most + "'",
       fmt::format("body '{}' rotates by up to {:.3g} rad in one step of {}, which is seldom accurate beyond {:g} rad",
                   report_.turned_most, report_.largest_turn, method_->info().name, kLongTurn),
       next, report_.largest_turn, kLongTurn, "rad"});
}

void StepLoop::warn_of_drift(double largest_before) {
  const double limit = options_.limits.of(system().length()).violation, now = report_.largest_violation;
  if (now <= limit || !(largest_before <= limit) || parts_->change.refusal) return;
  add_finding({&finding::violated_in_run, "",
               fmt::format("{}: the constraint violation is {:.2g} m after the step to t = {:.9g} s (limit {:.2g} m), "
                           "so the result is wrong",
                           method_->info().name, now, state_.t, limit),
               "project after each step (\"stabilization\": \"project\")", now, limit, "m", state_.t});
}

void StepLoop::add_finding(Finding f) {
  f.kind = &finding_kind(f.code());  // a checkpoint could not be read with others
  report_.findings.push_back(f);
  report_finding(f);
}

}  // namespace lockstep
