// SPDX-License-Identifier: BSD-3-Clause
// Explicit Runge-Kutta in lanes: every copy has its own time, step and error control; the attempts are made together. A
// copy whose attempt is rejected repeats it with a smaller step while the others continue.
#include "framework/tools/batch/lane_run.h"

#include <cmath>

#include <lockstep/error.h>
#include <lockstep/step_loop.h>
#include "framework/dynamics/simulate/consistency.h"

namespace lockstep::lanes {

void LaneRun::begin(std::span<const State> starts) {
  for (int l = 0; l < kLanes; ++l) {
    const bool used = l < batch_.size();
    starts_.push_back(starts[used ? l : 0]);
    lanes_[l].going = used;
    try {
      if (used) {
        Dynamics dynamics = task_.dynamics_of(batch_.system(l));
        check_start(dynamics, starts[l], StepLoopOptions().start_limit);
      }
      batch_.to_batch(l, starts_[l]);
      state_ = starts_[l];
    } catch (const Error& error) {  // a law
      lanes_[l].going = false;
      if (used) reports_[l].finished = false, reports_[l].error = error.what(), reports_[l].t = starts[l].t;
    }
  }
  if (!state_.coordinates) return;  // no start is good
  for (int l = 0; l < kLanes; ++l) {
    if (!lanes_[l].going && starts_[l].q.size() != state_.q.size()) starts_[l] = state_;
    batch_.put(l, starts_[l], y_.data());
    batch_.remember(l, starts_[l].z);
    t_[l] = starts_[l].t;
  }
  for (int l = 0; l < batch_.size(); ++l) {
    Lane& the = lanes_[l];
    if (!the.going) continue;
    const State start = starts_[l];  // arrive() may park the lane
    the.clock.set_end(task_.times.back(), start.t);
    the.clock.start(start.t);
    the.next = std::ranges::lower_bound(task_.times, start.t) - task_.times.begin();
    the.control.begin();
    reports_[l].t = start.t;
    arrive(l);
    if (the.going && batch_.watches()) find_redundancy(l, start);
    if (the.going) the.clock.begin(start.t, task_.options.step > 0 ? task_.options.step : first_step(l, start));
  }
  batch_.start_from(y_.data(), t_);
}

// The state of a copy in an array, at time t.
void LaneRun::read(int lane, const double* y, double t, State& out) const {
  batch_.get(lane, y, out);
  out.t = t, out.z = batch_.memory(lane);
  out.coordinates = starts_[lane].coordinates;
}

double LaneRun::first_step(int lane, const State& start) const {
  Dynamics dynamics = task_.dynamics_of(batch_.system(lane));
  const std::unique_ptr<Integrator> method = task_.make_integrator();
  method->set_tolerance(task_.options.tolerance);
  const double largest = lanes_[lane].clock.horizon(start.t);
  State own = start;
  try {
    dynamics.to_formulation(own);  // coordinates of its own
    method->begin(dynamics, own);
    return method->first_step(dynamics, own, largest);
  } catch (const Error&) {
    return largest;  // the run will hit and report the error
  }
}

// A copy whose rows are redundant on the constraints only leaves the lanes at once.
void LaneRun::find_redundancy(int lane, const State& start) {
  Lane& the = lanes_[lane];
  Dynamics dynamics = task_.dynamics_of(batch_.system(lane));
  State own = start;
  dynamics.to_formulation(own);
  const Redundancy found = dynamics.redundancy(own);
  the.usual = found.on_constraints ? -1 : std::max(found.rows, 0);
  the.near_below = near_singular_below(found.regular);
}

// The state of a copy as callers see it.
void LaneRun::see(int lane) {
  told_ = state_;
  read(lane, y_.data(), t_[lane], told_);
  batch_.to_slots(lane, told_);
}

// What is due at the target of a step: the jump of a law, then outputs.
void LaneRun::arrive(int lane) {
  Lane& the = lanes_[lane];
  if (the.target.jump) {
    const double before = t_[lane];
    t_[lane] = reports_[lane].t = the.target.t;
    if (!survives(lane, [&] { cross_jump(lane, before); })) return;
    tell_step(lane, true);
  }
  the.clock.set_anchor(t_[lane]);
  for (; the.going && the.next < task_.times.size() && task_.times[the.next] <= t_[lane]; ++the.next) {
    if (!survives(lane, [&] { see(lane); })) return;
    task_.output(batch_.first() + lane, the.next, told_);
    the.clock.pass_output();
  }
  the.going = the.going && the.next < task_.times.size();
}

// To callers that follow every step.
void LaneRun::tell_step(int lane, bool jumped) {
  if (task_.step && survives(lane, [&] { see(lane); })) task_.step(batch_.first() + lane, told_, jumped);
}

// Takes a copy from t, on the near side of the jump of a law, to its instant.
void LaneRun::cross_jump(int lane, double t) {
  State state = state_;
  read(lane, y_.data(), t, state);
  batch_.to_slots(lane, state);
  Dynamics dynamics = task_.dynamics_of(batch_.system(lane));
  pass_jump(dynamics, state, t_[lane]);
  batch_.remember(lane, state.z);
  batch_.to_batch(lane, state);
  batch_.put(lane, state, y_.data());
  jumped_ = true;
}

// False: the run is broken off, all copies have failed.
bool LaneRun::goes_on() {
  double reached = HUGE_VAL;
  for (int l = 0; l < kLanes; ++l)
    if (lanes_[l].going) reached = std::min(reached, t_[l]);
  try {
    task_.go_on_from(reached);
  } catch (const StepError& error) {
    for (int l = 0; l < kLanes; ++l)
      if (lanes_[l].going) fail(l, error);
    return false;
  }
  return true;
}

void LaneRun::accept(int lane, double error) {
  Lane& the = lanes_[lane];
  for (std::size_t i = lane; i < y_.size(); i += kL) y_[i] = end_[i];
  batch_.take_off_turns(lane, y_.data());
  batch_.accept(lane);
  first_done_ = false;
  t_[lane] = reports_[lane].t = the.lands ? the.target.reach : t_[lane] + h_[lane];
  ++reports_[lane].steps, the.clock.last().add(t_[lane]);
  const double next = fixed_ ? 0 : h_[lane] * the.control.accept(h_[lane], error, 0, the.rejected);
  the.clock.count_step(the.asked, {.h = h_[lane], .h_next = next});
  the.rejected = false, the.largest = 0;
  const auto end = [&] {
    const System& system = batch_.system(lane);
    if (passes::keeps_anything(system)) {
      read(lane, y_.data(), t_[lane], state_);
      passes::accept(system, inputs_.at(system, state_), state_);
      batch_.remember(lane, state_.z);
      batch_.put(lane, state_, y_.data());
    }
    if (t_[lane] < task_.times.back()) the.clock.check(t_[lane], reports_[lane].steps);
  };
  if (!survives(lane, end)) return;
  tell_step(lane, false);
  if (the.going && the.lands) arrive(lane);
}

// Repeats with a smaller step; a copy that cannot continue leaves for the scalar code, which reports the error.
void LaneRun::reject(int lane, double factor) {
  ++reports_[lane].rejected;
  lanes_[lane].rejected = true;
  lanes_[lane].largest = factor * h_[lane];
  if (fixed_ || step_vanished(t_[lane], lanes_[lane].largest, lanes_[lane].asked)) leave(lane);
}

// The run of a copy continues outside of the lanes.
void LaneRun::leave(int lane) {
  State state = state_;
  read(lane, y_.data(), t_[lane], state);
  park(lane);
  if (!survives(lane, [&] { batch_.to_slots(lane, state); })) return;
  // Without projection its drift is as large as its errors.
  const bool projects = task_.options.stabilization.kind == Stabilization::Kind::project;
  const double limit = projects ? StepLoopOptions().start_limit : HUGE_VAL;
  run_alone(batch_.system(lane), batch_.first() + lane, std::move(state), lanes_[lane].next, limit, task_,
            reports_[lane]);
}

void LaneRun::fail(int lane, const Error& error) {
  park(lane);
  reports_[lane].finished = false;
  reports_[lane].error = error.what();
}

// Ends stepping in a lane, which stays at a state at which it can be evaluated.
void LaneRun::park(int lane) {
  lanes_[lane].going = false;
  batch_.put(lane, starts_[lane], y_.data());
  batch_.remember(lane, starts_[lane].z);
  t_[lane] = starts_[lane].t;
  first_done_ = false;
}

}  // namespace lockstep::lanes
