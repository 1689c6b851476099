// SPDX-License-Identifier: BSD-3-Clause
// Explicit Runge-Kutta in lanes: every copy has its own time, step and error control; the attempts are made together. A
// copy whose attempt is rejected repeats it with a smaller step while the others continue.
#include "framework/tools/batch/lane_run.h"

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>

namespace lockstep::lanes {

void LaneRun::begin(std::span<const State> starts) {
  int first_good = -1;
  for (std::size_t l = 0; l < kL; ++l) {
    starts_.push_back(starts[l < starts.size() ? l : 0]);
    lanes_[l].going = l < starts.size();
    try {
      if (l < starts.size()) {
        Dynamics dynamics = dynamics_of(static_cast<int>(l));
        check_copy(dynamics, starts[l]);
      }
      batch_.to_batch(static_cast<int>(l), starts_[l]);
      if (first_good < 0) first_good = static_cast<int>(l);
    } catch (const Error& error) {  // a law
      lanes_[l].going = false;
      if (l < starts.size())
        reports_[l].finished = false, reports_[l].error = error.what(), reports_[l].t = starts[l].t;
    }
  }
  if (first_good < 0) return;
  const auto good = static_cast<std::size_t>(first_good);
  state_ = state_end_ = starts_[good];
  rate_ = rate_error_ = sized_like(state_);
  for (std::size_t l = 0; l < kL; ++l) {
    const int lane = static_cast<int>(l);
    if (!lanes_[l].going && starts_[l].q.size() != state_.q.size()) starts_[l] = state_;
    batch_.put(lane, starts_[l], y_.data());
    batch_.remember(lane, starts_[l].z);
    t_[l] = starts_[l].t;
  }
  for (std::size_t l = 0; l < starts.size(); ++l) {
    Lane& the = lanes_[l];
    if (!the.going) continue;
    const int lane = static_cast<int>(l);
    const State start = starts_[l];  // arrive() may park the lane
    the.schedule.begin(batch_.system(lane), start.t, task_.times);
    the.norm.set(task_.options.tolerance);
    the.norm.set_states(batch_.system(lane).n_error_controlled_states());
    the.norm.scale(start, 1.0);
    the.control.begin();
    the.last.begin(start.t);
    reports_[l].t = start.t;
    if (the.schedule.reach() <= start.t) arrive(lane);
    if (the.going && batch_.watches()) find_redundancy(lane, start);
    if (the.going) the.advised = task_.options.step > 0 ? task_.options.step : first_step(lane, start);
  }
  batch_.start_from(y_.data(), t_);
}

// The state of a copy in an array, at time t.
void LaneRun::read(int lane, const double* y, double t, State& out) const {
  const auto l = static_cast<std::size_t>(lane);
  batch_.get(lane, y, out);
  out.t = t, out.z = batch_.memory(lane);
  out.coordinates = starts_[l].coordinates;
}

Dynamics LaneRun::dynamics_of(int lane) const {
  DynamicsOptions options;
  options.stabilization = task_.options.stabilization;
  options.formulation = Formulation::joint;
  return Dynamics(batch_.system(lane), std::make_unique<SchurSolver>(), options);
}

double LaneRun::first_step(int lane, const State& start) const {
  Dynamics dynamics = dynamics_of(lane);
  ErrorNorm norm = lanes_[lane].norm;
  StateRate f0 = sized_like(start), f1 = f0;
  State y0 = start, y1;
  double largest = lanes_[lane].schedule.reach() - start.t;
  if (task_.options.max_step > 0) largest = std::min(largest, task_.options.max_step);
  try {
    batch_.to_slots(lane, y0);
    dynamics.to_formulation(y0);  // coordinates of its own
    y1 = y0;
    return guess_first_step(dynamics, y0, tableau_.order, largest, norm, f0, f1, y1);
  } catch (const Error&) {
    return largest;  // the run will hit and report the error
  }
}

// A copy whose rows are redundant on the constraints only leaves the lanes at once.
void LaneRun::find_redundancy(int lane, const State& start) {
  Lane& the = lanes_[lane];
  Dynamics dynamics = dynamics_of(lane);
  State own = start;
  batch_.to_slots(lane, own);
  dynamics.to_formulation(own);
  const Redundancy found = dynamics.redundancy(own);
  the.usual = found.on_constraints ? -1 : std::max(found.rows, 0);
  the.near_below = near_singular_below(found.regular);
}

// Ends a step at the schedule's next instant.
void LaneRun::arrive(int lane) {
  const auto l = static_cast<std::size_t>(lane);
  Lane& the = lanes_[l];
  const double before = t_[l];
  bool output = false;
  t_[l] = reports_[l].t = the.schedule.arrive(output);
  told_ = state_;
  try {
    if (output) {
      read(lane, y_.data(), t_[l], told_);
      batch_.to_slots(lane, told_);
    } else {
      cross_jump(lane, before);
    }
  } catch (const Error& error) {  // a law
    return fail(lane, error);
  }
  if (output)
    task_.tell(batch_.first() + lane, the.schedule.next() - 1, told_);
  else
    tell_step(lane, true);
  the.going = the.going && !the.schedule.done();
  if (the.going && the.schedule.reach() <= t_[l]) arrive(lane);  // an output at a jump, or a jump just behind one
}

// To callers that follow every step.
void LaneRun::tell_step(int lane, bool jumped) {
  if (!task_.step) return;
  told_ = state_;
  try {
    read(lane, y_.data(), t_[lane], told_);
    batch_.to_slots(lane, told_);
  } catch (const Error& error) {  // a law
    return fail(lane, error);
  }
  task_.tell_step(batch_.first() + lane, told_, jumped);
}

// Takes a copy from t, on the near side of the jump of a law, to its instant.
void LaneRun::cross_jump(int lane, double t) {
  State state = state_;
  read(lane, y_.data(), t, state);
  batch_.to_slots(lane, state);
  Dynamics dynamics = dynamics_of(lane);
  pass_jump(dynamics, state, t_[lane]);
  batch_.remember(lane, state.z);
  batch_.to_batch(lane, state);
  batch_.put(lane, state, y_.data());
  jumped_ = true;
}

// False: the run is broken off, all copies have failed.
bool LaneRun::goes_on() {
  double reached = HUGE_VAL;
  for (std::size_t l = 0; l < kL; ++l)
    if (lanes_[l].going) reached = std::min(reached, t_[l]);
  try {
    task_.go_on_from(reached);
  } catch (const StepError& error) {
    for (std::size_t l = 0; l < kL; ++l)
      if (lanes_[l].going) fail(static_cast<int>(l), error);
    return false;
  }
  return true;
}

void LaneRun::accept(int lane, double error) {
  const auto l = static_cast<std::size_t>(lane);
  Lane& the = lanes_[l];
  for (std::size_t i = l; i < y_.size(); i += kL) y_[i] = end_[i];
  batch_.take_off_turns(lane, y_.data());
  batch_.accept(lane);
  first_done_ = false;
  t_[l] = the.lands ? the.schedule.reach() : t_[l] + h_[l];
  reports_[l].t = t_[l];
  ++reports_[l].steps, the.last.add(t_[l]);
  if (!fixed_) {
    const double next = h_[l] * the.control.accept(h_[l], error, 0, the.rejected);
    the.advised = the.rejected ? next : advised_after(the.asked, h_[l], h_[l], next);
  }
  the.rejected = false;
  try {
    update_memory(lane);
    if (!the.schedule.done() && t_[l] < the.schedule.end())
      check_length(the.last, task_, the.schedule.end(), t_[l], reports_[l].steps);
  } catch (const Error& failure) {
    return fail(lane, failure);
  }
  tell_step(lane, false);
  if (the.going && the.lands) arrive(lane);
}

void LaneRun::update_memory(int lane) {
  const System& system = batch_.system(lane);
  if (!passes::keeps_anything(system)) return;
  read(lane, y_.data(), t_[lane], state_);
  passes::accept(system, inputs_.at(system, state_), state_);
  batch_.remember(lane, state_.z);
  batch_.put(lane, state_, y_.data());
}

// Repeats with a smaller step; a copy that cannot continue leaves for the scalar code, which reports the error.
void LaneRun::reject(int lane, double factor) {
  const auto l = static_cast<std::size_t>(lane);
  ++reports_[l].rejected;
  lanes_[l].rejected = true;
  lanes_[l].advised = factor * h_[l];
  if (fixed_ || step_vanished(t_[l], lanes_[l].advised, lanes_[l].asked)) leave(lane);
}

// The run of a copy continues outside of the lanes.
void LaneRun::leave(int lane) {
  const auto l = static_cast<std::size_t>(lane);
  State state = state_;
  read(lane, y_.data(), t_[l], state);
  park(lane);
  try {
    batch_.to_slots(lane, state);
  } catch (const Error& error) {
    return fail(lane, error);
  }
  // Without projection its drift is as large as its errors.
  const bool projects = task_.options.stabilization.kind == Stabilization::Kind::project;
  const double limit = projects ? StepLoopOptions().start_limit : HUGE_VAL;
  run_alone(batch_.system(lane), batch_.first() + lane, std::move(state), lanes_[l].schedule.next(), limit, task_,
            reports_[l]);
}

void LaneRun::fail(int lane, const Error& error) {
  park(lane);
  reports_[lane].finished = false;
  reports_[lane].error = error.what();
}

// Ends stepping in a lane, which stays at a state at which it can be evaluated.
void LaneRun::park(int lane) {
  const auto l = static_cast<std::size_t>(lane);
  lanes_[l].going = false;
  batch_.put(lane, starts_[l], y_.data());
  batch_.remember(lane, starts_[l].z);
  t_[l] = starts_[l].t;
  first_done_ = false;
}

void run_lanes(Batch& batch, std::span<const State> starts, const RunTask& task, std::span<CopyReport> reports) {
  LaneRun(batch, task, reports).run(starts);
}

}  // namespace lockstep::lanes
