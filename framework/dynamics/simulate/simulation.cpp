#include "framework/dynamics/simulate/simulation.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "framework/dynamics/simulate/simulation_loop.h"
#include "framework/foundation/support/error.h"

namespace lockstep {

namespace {

// Name of the row that is violated most, by the norm of the dynamics. Only on the way to an error.
std::string worst_row(Dynamics& dynamics, const State& state) {
  dynamics.gather(state);
  const RowTable& rows = dynamics.rows();
  VecX c = VecX::Zero(rows.n_rows);
  int worst = 0;
  double most = -1;
  for (const RowEntry& e : rows.entries)
    for (int k = 0; k < e.m; ++k) {
      const int row = e.first_row + k;
      c[row] = rows.block(e).C(k);
      const double size = dynamics.norm(c);
      c[row] = 0;
      if (size > most) most = size, worst = row;
    }
  return rows.n_rows > 0 ? dynamics.system().row_name(rows, worst) : "no row";
}

void check_start(Dynamics& dynamics, const State& s, double limit) {
  const double c = dynamics.violation(s);
  if (!(c <= limit))
    throw AssemblyError(
        fmt::format("the start at t = {:.9g} s violates the constraints by {:.3g} m (limit {:.3g} m), most of "
                    "all {}; assemble it first",
                    s.t, c, limit, worst_row(dynamics, s)));
  const double cv = dynamics.violation_v(s);
  if (!(cv <= limit))
    throw AssemblyError(
        fmt::format("the start velocities at t = {:.9g} s violate the constraints by {:.3g} m/s (limit {:.3g} "
                    "m/s); assemble them first",
                    s.t, cv, limit));
}

}  // namespace

Simulation::Simulation(Dynamics& dynamics, std::unique_ptr<Integrator> method, SimulationOptions options)
    : dynamics_(dynamics),
      method_(std::move(method)),
      options_(std::move(options)),
      loop_(std::make_unique<Loop>(*this)) {
  if (!method_) throw ModelError("a simulation needs an integrator; take one from the registry");
  const auto bad = [](double x) { return !std::isfinite(x) || x < 0; };
  if (bad(options_.step))
    throw ModelError(fmt::format("the step of {} s must be a number of seconds > 0", options_.step));
  if (bad(options_.output)) throw ModelError(fmt::format("the output interval of {} s must be > 0", options_.output));
  if (bad(options_.tolerance.relative) || bad(options_.tolerance.atol_x) ||
      options_.tolerance.relative + options_.tolerance.atol_x == 0)
    throw ModelError(fmt::format("the tolerance (relative {}, absolute {} m) must be > 0", options_.tolerance.relative,
                                 options_.tolerance.atol_x));
  const std::vector<double>& times = options_.output_times;
  if (!std::is_sorted(times.begin(), times.end()) ||
      !std::all_of(times.begin(), times.end(), [](double t) { return std::isfinite(t); }))
    throw ModelError("the output times must be finite and rising; sort them");
  const IntegratorInfo info = method_->info();
  if (!info.adaptive && options_.step == 0)
    throw ModelError(
        fmt::format("{} works with a fixed step; say which: SimulationOptions::step, or --step", info.name));
  method_->set_tolerance(options_.tolerance);
  dynamics_.set_up();
  state_ = dynamics_.system().start();
}

Simulation::~Simulation() = default;

void Simulation::set_state(State state) {
  system().check_size(state);
  check_start(dynamics_, state, options_.start_limit);
  state_ = std::move(state);
  begun_ = false;
}

void Simulation::add_observer(Observer& observer) {
  observers_.push_back(&observer);
  if (begun_) observer.start(Sample(dynamics_, state_, loop_->step));
}

Event& Simulation::add_event(Event event) {
  if (!event.value && !(event.at >= 0))
    throw ModelError(
        fmt::format("event '{}' has neither an instant (at >= 0) nor a condition (value); give one", event.name));
  if (!(event.tolerance > 0))
    throw ModelError(fmt::format("event '{}': its tolerance of {} s must be > 0", event.name, event.tolerance));
  for (const std::vector<std::string>* names : {&event.activate, &event.deactivate})
    for (const std::string& name : *names)
      if (system().merged(system().link(name)))
        throw ModelError(
            fmt::format("event '{}': link '{}' is merged into one slot and cannot be switched; keep it, as in "
                        "set_merge(true, {{&link}})",
                        event.name, name));
  events_.push_back(std::move(event));
  if (begun_) {
    loop_->watched.push_back({});
    loop_->watched.back().over = !events_.back().value && events_.back().at < state_.t;
    loop_->watch();
  }
  return events_.back();
}

const SimulationReport& Simulation::run_until(double t) {
  if (!std::isfinite(t) || t < state_.t)
    throw ModelError(
        fmt::format("the end time of {} s must be finite and not before the present time of {} s", t, state_.t));
  report_.stopped = false;
  report_.stopped_by.clear();
  try {
    loop_->t_end = t;
    loop_->start();
    while (!report_.stopped && state_.t < t) loop_->advance(t, 0);
    loop_->output_end();
  } catch (const SolveError& e) {
    loop_->finish(true);
    throw SolveError(fmt::format("{} (the last accepted state is at t = {:.9g} s)", e.what(), state_.t));
  } catch (...) {
    loop_->finish(true);
    throw;
  }
  loop_->finish(false);
  return report_;
}

StepReport Simulation::step(double h) {
  if (!std::isfinite(h) || h < 0)
    throw ModelError(fmt::format("a step of {} s must be > 0, or 0 for the method's own", h));
  loop_->t_end = std::numeric_limits<double>::infinity();
  report_.stopped = false;
  report_.stopped_by.clear();
  loop_->start();
  if (!report_.stopped) loop_->advance(std::numeric_limits<double>::infinity(), h);
  return loop_->step;
}

void Simulation::Loop::start() {
  if (sim.begun_) return;
  sim.system().check_size(sim.state_);
  check_start(sim.dynamics_, sim.state_, sim.options_.start_limit);
  sim.dynamics_.accept(sim.state_);  // what is remembered shall know the speeds of the start too
  adaptive = sim.method_->info().adaptive;
  from = scratch = sim.state_;
  step = {};
  sim.report_ = {};
  t_start = sim.state_.t;
  next_output = 0;
  breakpoints_to = -std::numeric_limits<double>::infinity();
  last_output = -std::numeric_limits<double>::infinity();
  watched.assign(sim.events_.size(), {});
  for (std::size_t i = 0; i < watched.size(); ++i)
    watched[i].over = !sim.events_[i].value && sim.events_[i].at < t_start;
  contacts.lay_out(sim.system(), sim.dynamics_.options().stabilization);
  if (!contacts.empty()) begin_contacts(), settle_contacts();
  sim.begun_ = true;
  started = true;
  const Sample sample(sim.dynamics_, sim.state_, step);
  for (Observer* o : sim.observers_) o->start(sample);
  skip_outputs_before(t_start);
  if (output_due_at_end()) put_out(sample);
  begin_method();
  const bool changed = fire_due();
  if (contacts.empty()) return;
  if (changed) settle_contacts();
  note_contacts(true);
}

void Simulation::Loop::advance(double limit, double largest) {
  refresh_breakpoints(limit, largest);
  const Target target = next_target(limit);
  const double wanted = step_towards(target, largest);
  from = sim.state_;
  if (!has_dense) before.clear(), sim.method_->save(before);
  step = named(*sim.method_, from.t, [&] { return sim.method_->step(sim.dynamics_, sim.state_, wanted); });
  bool landed = step.h >= wanted && sim.state_.t >= target.reach - 1e-13 * std::max(std::abs(target.reach), wanted);
  if (landed) sim.state_.t = target.reach;
  take_advice(wanted);
  const bool touched = !contacts.empty() && locate_contacts();
  const bool met = !sim.events_.empty() && locate_events();
  if ((met || touched) && sim.state_.t < target.reach) landed = false;
  if (landed && target.jump) cross_to(target.t);
  sim.dynamics_.accept(sim.state_);
  ++sim.report_.steps;
  sim.report_.rejected += step.rejected;
  if (step.manifold) ++sim.report_.manifold_steps;
  if (step.stiff) sim.report_.stiff_since = std::min(sim.report_.stiff_since, sim.state_.t);
  sim.report_.largest_violation = std::max(sim.report_.largest_violation, step.violation_after);
  outputs_inside(from.t, sim.state_.t);
  observe_end();
  if (landed && target.jump) make_consistent("the jump of a law");
  if (landed || met || touched) anchor = sim.state_.t, n_from_anchor = 0;
  const bool changed = !sim.events_.empty() && fire_due();
  const bool moved = changed || met || touched || (landed && target.jump);
  if (!contacts.empty()) {
    if (moved) settle_contacts();
    note_contacts(moved);
  }
  if (!moved) return;
  const Sample sample(sim.dynamics_, sim.state_, step);
  for (Observer* o : sim.observers_) o->jumped(sample);
}

void Simulation::Loop::observe_end() {
  const Sample sample(sim.dynamics_, sim.state_, step);
  for (Observer* o : sim.observers_) o->step(sample);
  if (output_due_at_end()) put_out(sample);
  if (sim.progress && !sim.progress(sim.state_)) {
    sim.report_.stopped = true;
    sim.report_.stopped_by = "the caller";
  }
}

void Simulation::Loop::finish(bool quietly) {
  if (!started) return;
  std::exception_ptr first;
  const Sample sample(sim.dynamics_, sim.state_, step);
  for (Observer* o : sim.observers_) {
    try {
      o->finish(sample);
    } catch (...) {
      if (!first) first = std::current_exception();
    }
  }
  if (first && !quietly) std::rethrow_exception(first);
}

}  // namespace lockstep
