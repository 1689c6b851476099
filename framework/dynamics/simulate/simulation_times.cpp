// Where the step loop lands, and which instants it puts out.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/dynamics/simulate/simulation_loop.h"
#include "framework/foundation/support/error.h"

namespace lockstep {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSameInstant = 1e-12;  // of max(|t|, length of the run): what is nearer is merged

}  // namespace

// A law jumps at t: its left side is integrated up to a hair before t, so that no stage sees the right side; the hair
// itself is crossed by the rates there (cross_to). It is wider than the share of its own duration by which a law may
// count an instant as the jump (motionlaws/side.h: 1e-12), for laws up to a hundred times as long as the run.
Simulation::Loop::Target Simulation::Loop::next_target(double limit) {
  const double t = sim.state_.t;
  double next = limit;
  for (std::size_t i = 0; i < sim.events_.size(); ++i) {
    const Event& e = sim.events_[i];
    if (!e.value && !watched[i].over && e.at > t) next = std::min(next, e.at);
  }
  if (!has_dense) {
    const double out = output_time(next_output);
    if (out > t) next = std::min(next, out);
  }
  while (next_breakpoint < breakpoints.size() && breakpoints[next_breakpoint] <= t) ++next_breakpoint;
  Target target{next, next, false};
  if (next_breakpoint < breakpoints.size() && breakpoints[next_breakpoint] <= next) {
    const double jump = breakpoints[next_breakpoint];
    const double span = std::isfinite(t_end) ? t_end - t_start : 0;
    const double hair = 1e-10 * std::max({std::abs(jump), jump - t, span});
    target = {jump, jump - hair > t ? jump - hair : jump, true};
  }
  return target;
}

// The last hair before a jump, by the rates on its left side; the error is the square of the hair.
void Simulation::Loop::cross_to(double t) {
  State& state = sim.state_;
  const double h = t - state.t;
  if (h > 0) {
    sim.dynamics_.rate(state, hair_rate);
    state.q += h * hair_rate.q;
    state.v += h * hair_rate.v;
    state.s += h * hair_rate.s;
    sim.dynamics_.normalize(state);
  }
  state.t = t;
}

double Simulation::Loop::step_towards(const Target& target, double largest) const {
  const double t = sim.state_.t, left = target.reach - t;
  if (fixed()) {
    const double size = largest > 0 ? largest : sim.options_.step;
    const double end = largest > 0 ? t + size : anchor + static_cast<double>(n_from_anchor + 1) * size;
    return end >= target.reach - 1e-9 * size ? left : end - t;
  }
  double h = advised > 0 ? advised : kInfinity;
  if (sim.options_.step > 0) h = std::min(h, sim.options_.step);
  if (largest > 0) h = std::min(h, largest);
  const double span = std::isfinite(t_end) ? t_end - t_start : 0;
  if (h < 1e-14 * std::max(std::abs(t), span))
    throw StepError(
        fmt::format("{}: the step shrank to {:.3g} s at t = {:.9g} s; take another method (--integrator), a wider "
                    "tolerance, or look for a singular place (lockstep check)",
                    sim.method_->info().name, h, t),
        t);
  if (h >= left - kSameInstant * std::max(std::abs(t), span)) return left;
  if (2 * h > left) return 0.5 * left;  // two equal steps rather than a whole one and a sliver
  return h;
}

// A step cut short by a landing says nothing against the longer one that was advised before.
void Simulation::Loop::take_advice(double asked) {
  ++n_from_anchor;
  if (fixed()) return;
  const bool cut = asked < advised && step.h >= asked;
  advised = cut ? std::max(advised, step.h_next) : step.h_next;
}

void Simulation::Loop::refresh_breakpoints(double limit, double largest) {
  const double t = sim.state_.t;
  const double size = std::max({advised, sim.options_.step, largest});
  const bool open = !std::isfinite(limit);  // single steps: no end is known
  if (breakpoints_to >= (open ? t + 2 * size : limit)) return;
  const double far = open ? t + 256 * size : limit;
  breakpoints = sim.system().breakpoints(t, std::nextafter(far, kInfinity));  // one at the very end is landed on too
  breakpoints_to = far;
  next_breakpoint = 0;
}

double Simulation::Loop::output_time(long k) const {
  double t = kInfinity;
  const std::vector<double>& times = sim.options_.output_times;
  if (!times.empty()) {
    if (k < static_cast<long>(times.size())) t = times[static_cast<std::size_t>(k)];
  } else if (sim.options_.output > 0) {
    t = t_start + static_cast<double>(k) * sim.options_.output;
    if (std::abs(t - t_end) < 1e-9 * sim.options_.output) t = t_end;
  }
  return t;
}

void Simulation::Loop::skip_outputs_before(double t) {
  while (output_time(next_output) < t) ++next_output;
}

void Simulation::Loop::outputs_inside(double t0, double t1) {
  for (double t = output_time(next_output); t < t1; t = output_time(++next_output)) {
    if (t <= t0 || !has_dense) continue;
    state_at(t, scratch);
    put_out(Sample(sim.dynamics_, scratch, step));
  }
}

// Every step when no times were asked for; else the asked instants, and the end of the run beside an interval.
bool Simulation::Loop::output_due_at_end() {
  const double t = sim.state_.t;
  if (sim.options_.output_times.empty() && sim.options_.output == 0) return true;
  if (output_time(next_output) == t) {
    ++next_output;
    return true;
  }
  return sim.options_.output_times.empty() && t == t_start;
}

void Simulation::Loop::put_out(const Sample& sample) {
  last_output = sample.state.t;
  for (Observer* o : sim.observers_) o->output(sample);
}

void Simulation::Loop::output_end() {
  if (!sim.options_.output_times.empty() || sim.options_.output == 0 || last_output == sim.state_.t) return;
  put_out(Sample(sim.dynamics_, sim.state_, step));
}

}  // namespace lockstep
