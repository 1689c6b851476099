// Events of the step loop: conditions located inside a step, links switched, velocities made consistent, the method
// begun anew.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/dynamics/simulate/simulation_loop.h"
#include "framework/foundation/support/error.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

void Simulation::Loop::watch() {
  for (std::size_t i = 0; i < sim.events_.size(); ++i)
    if (sim.events_[i].value && !watched[i].over) watched[i].value = value_of(i, sim.state_);
}

double Simulation::Loop::value_of(std::size_t event, const State& state) {
  const double g = sim.events_[event].value(Sample(sim.dynamics_, state, step));
  if (std::isfinite(g)) return g;
  throw NonFiniteError(fmt::format("the condition of event '{}' is {} at t = {:.9g} s; it must be a finite number",
                                   sim.events_[event].name, g, state.t),
                       state.t);
}

// Strictly from one side: a condition that is zero at the beginning of a step has not been crossed by it.
bool Simulation::Loop::crosses(std::size_t event, double now) const {
  const double was = watched[event].value;
  const bool rises = was < 0 && now >= 0, falls = was > 0 && now <= 0;
  switch (sim.events_[event].crossing) {
    case Event::Crossing::rising:
      return rises;
    case Event::Crossing::falling:
      return falls;
    default:
      return rises || falls;
  }
}

// The state at t inside the present step, on the constraints: by dense output, or by a shorter step for a method
// without.
void Simulation::Loop::state_at(double t, State& out) {
  if (has_dense) {
    named(*sim.method_, t, [&] { return sim.method_->dense(t, out); });
    if (!projecting()) return;
    const ProjectReport report = sim.dynamics_.project(out);
    if (!report.converged)
      throw StepError(
          fmt::format("the state interpolated at t = {:.9g} s is {:.3g} m off the constraints and could not be "
                      "brought back; take a smaller tolerance",
                      t, report.before),
          from.t);
    return;
  }
  out = from;
  if (t <= from.t) return;
  before.rewind();
  sim.method_->restore(before);
  for (double left = t - from.t; left > 0; left = t - out.t) {
    const StepReport part = named(*sim.method_, out.t, [&] { return sim.method_->step(sim.dynamics_, out, left); });
    if (part.h >= left) break;
  }
  out.t = t;
}

// Bracket [a, b] with the crossing inside; Illinois' false position, a bisection whenever two tries did not halve it.
// The far end is the instant: there the condition has its new sign, so that it is not met again at once.
double Simulation::Loop::locate(std::size_t event, double t1) {
  const double tolerance =
      std::max(sim.events_[event].tolerance, 4 * std::numeric_limits<double>::epsilon() * std::abs(t1));
  double a = from.t, b = t1, ga = watched[event].value, gb = watched[event].now;
  const double sign = ga > 0 ? 1 : -1;
  double width = b - a;
  for (int i = 0; b - a > tolerance; ++i) {
    double t = gb == 0 ? b - 0.5 * tolerance : b - gb * (b - a) / (gb - ga);
    if (i % 3 == 2) {
      if (b - a > 0.5 * width) t = 0.5 * (a + b);
      width = b - a;
    }
    t = std::clamp(t, a + 0.5 * tolerance, b - 0.5 * tolerance);
    state_at(t, scratch);
    const double g = value_of(event, scratch);
    if (g * sign > 0) {
      a = t, ga = g, gb *= 0.5;
    } else {
      b = t, gb = g, ga *= 0.5;
    }
  }
  return b;
}

bool Simulation::Loop::locate_events() {
  const double t1 = sim.state_.t;
  double first = std::numeric_limits<double>::infinity();
  bool crossed = false;
  for (std::size_t i = 0; i < sim.events_.size(); ++i) {
    const Event& e = sim.events_[i];
    Watched& w = watched[i];
    w.met = false;
    if (!e.value || w.over) continue;
    w.now = value_of(i, sim.state_);
    if (!crosses(i, w.now)) continue;
    if (!crossed && !has_dense) after.clear(), sim.method_->save(after);
    crossed = true;
    const double t = locate(i, t1);
    w.met = t - w.last > 2 * e.tolerance;  // the same instant again does not count
    w.at = t;
    if (w.met) first = std::min(first, t);
  }
  if (std::isfinite(first) && first < t1) {
    state_at(first, scratch);
    sim.state_ = scratch;
    step.h = first - from.t;
    for (std::size_t i = 0; i < sim.events_.size(); ++i) {
      Watched& w = watched[i];
      if (!sim.events_[i].value || w.over) continue;
      const double g = value_of(i, sim.state_);
      w.met = w.met && (w.at <= first || crosses(i, g));
      w.now = g;
    }
  } else if (crossed && !has_dense) {
    after.rewind();
    sim.method_->restore(after);
  }
  for (Watched& w : watched) w.value = w.now;
  return std::isfinite(first);
}

bool Simulation::Loop::fire_due() {
  const double t = sim.state_.t;
  bool changed = false, rewound = false;
  std::string cause;
  for (std::size_t i = 0; i < sim.events_.size(); ++i) {
    const Event& e = sim.events_[i];
    Watched& w = watched[i];
    const bool due = e.value ? w.met : !w.over && e.at <= t;
    if (!due) continue;
    rewound = rewound || w.met;
    w.met = false;
    w.last = t;
    w.over = e.once || !e.value;
    if (e.stop) sim.report_.stopped = true, sim.report_.stopped_by = e.name;
    if (e.activate.empty() && e.deactivate.empty() && !e.change) continue;
    act(e);
    changed = true;
    cause += (cause.empty() ? "event '" : ", '") + e.name + "'";
  }
  if (changed) make_consistent(cause);
  if (changed || rewound) begin_method();
  return changed;
}

void Simulation::Loop::act(const Event& e) {
  const auto put = [&](const std::string& name, bool on) {  // a one-sided link comes into force when it is touched
    const Lock& link = sim.system().link(name);
    sim.state_.modes[static_cast<std::size_t>(link.number())] = on && !link.unilateral();
    if (link.unilateral()) sim.state_.z[link.impact_memory() + 1] = on ? 1.0 : 0.0;
  };
  for (const std::string& name : e.activate) put(name, true);
  for (const std::string& name : e.deactivate) put(name, false);
  if (e.change) e.change(sim.state_);
  if (!sim.state_.q.allFinite() || !sim.state_.v.allFinite() || !sim.state_.s.allFinite())
    throw NonFiniteError(fmt::format("event '{}' made the state not finite at t = {:.9g} s", e.name, sim.state_.t),
                         sim.state_.t);
  sim.dynamics_.normalize(sim.state_);
  engage(e.activate);
  check_links(e.activate, "event '" + e.name + "'");
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (std::find(e.activate.begin(), e.activate.end(), contacts[i].link->name()) != e.activate.end())
      check_side(i, "event '" + e.name + "' at t = " + fmt::format("{:.9g}", sim.state_.t) + " s");
}

// Own states of links that come into force: a driven speed begins where the mechanism is.
void Simulation::Loop::engage(const std::vector<std::string>& links) {
  for (const std::string& name : links) {
    const Lock& link = sim.system().link(name);
    const int n = link.n_own_states();
    if (n == 0) continue;
    sim.dynamics_.gather(sim.state_);
    named(link, sim.state_.t, [&] {
      link.stateful()->engage(sim.dynamics_.inputs(),
                              {sim.state_.s.data() + link.first_state(), static_cast<std::size_t>(n)});
    });
  }
}

// A link that is put in force must fit where it is: nothing is pulled together from afar.
void Simulation::Loop::check_links(const std::vector<std::string>& links, const std::string& cause) {
  sim.dynamics_.gather(sim.state_);
  const RowTable& rows = sim.dynamics_.rows();
  for (const std::string& name : links) {
    const int entry = rows.entry_of_link[static_cast<std::size_t>(sim.system().link(name).number())];
    if (entry < 0) continue;
    const RowEntry& e = rows.entries[static_cast<std::size_t>(entry)];
    VecX c = VecX::Zero(rows.n_rows);
    for (int k = 0; k < e.m; ++k) c[e.first_row + k] = rows.block(e).C(k);
    const double violation = sim.dynamics_.norm(c);
    if (!(violation <= sim.options_.start_limit))
      throw AssemblyError(
          fmt::format("{} puts link '{}' in force at t = {:.9g} s, where it is {:.3g} m apart (limit {:.3g} m); "
                      "let the event come when its markers meet",
                      cause, name, sim.state_.t, violation, sim.options_.start_limit));
  }
}

// Onto the constraints where positions are projected (by a hair: more is refused), velocities always: an inelastic
// impact.
void Simulation::Loop::make_consistent(const std::string& cause) {
  State& state = sim.state_;
  double left = 0;
  if (projecting()) {
    const double violation = sim.dynamics_.violation(state);
    const bool near = violation <= sim.options_.start_limit;
    const ProjectReport report = near ? sim.dynamics_.project(state) : ProjectReport{};
    if (!near || !report.converged)
      throw AssemblyError(fmt::format("{} leaves the constraints violated by {:.3g} m at t = {:.9g} s (limit {:.3g} m)",
                                      cause, violation, state.t, sim.options_.start_limit));
    left = report.after_v;
  } else {
    left = sim.dynamics_.project_velocity(state);
  }
  if (!(left <= sim.options_.start_limit))
    throw AssemblyError(
        fmt::format("{} at t = {:.9g} s leaves velocities that no motion can have, {:.3g} m/s beside the "
                    "constraints (limit {:.3g} m/s); two laws may drive one coordinate",
                    cause, state.t, left, sim.options_.start_limit));
  sim.dynamics_.accept(state);
  if (!sim.events_.empty()) watch();
}

void Simulation::Loop::begin_method() {
  const double t = sim.state_.t;
  named(*sim.method_, t, [&] { sim.method_->begin(sim.dynamics_, sim.state_); });
  from = scratch = sim.state_;
  has_dense = named(*sim.method_, t, [&] { return sim.method_->dense(t, scratch); });
  anchor = sim.state_.t;
  n_from_anchor = 0;
  if (adaptive) {
    double largest = std::isfinite(t_end) ? t_end - t : 1.0;
    if (sim.options_.step > 0) largest = std::min(largest, sim.options_.step);
    advised = 0;
    if (largest > 0)
      advised = named(*sim.method_, t, [&] { return sim.method_->first_step(sim.dynamics_, sim.state_, largest); });
    if (!(advised > 0)) advised = sim.options_.step > 0 ? sim.options_.step : 1e-3;
  } else {
    advised = sim.options_.step;
  }
  watch();
}

}  // namespace lockstep
