// SPDX-License-Identifier: BSD-3-Clause
// What a step loop writes to a checkpoint, and reads.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <boost/core/demangle.hpp>
#include <typeinfo>
#include <utility>
#include <vector>

#include <lockstep/error.h>
#include "framework/dynamics/simulate/step_loop_parts.h"
#include "framework/foundation/support/thrown.h"

namespace lockstep {

namespace {

void save_report(const SimulationReport& r, Snapshot& out) {
  for (const long n : {r.steps, r.rejected, r.impacts, r.manifold_steps}) out.put(static_cast<double>(n));
  for (const double x : {r.largest_violation, r.stiff_since, r.largest_turn, r.stopped ? 1.0 : 0.0}) out.put(x);
  out.put_text(r.turned_most), out.put_text(r.stopped_by);
  out.put(static_cast<double>(r.findings.size()));
  for (const Finding& f : r.findings) {
    for (const std::string& text : {std::string(f.code()), f.thing, f.message, f.advice, f.unit, f.place})
      out.put_text(text);
    out.put(f.value), out.put(f.limit), out.put(f.t);
  }
}

SimulationReport load_report(SnapshotReader& in) {
  SimulationReport r;
  for (long* n : {&r.steps, &r.rejected, &r.impacts, &r.manifold_steps}) *n = in.get_count();
  for (double* x : {&r.largest_violation, &r.stiff_since, &r.largest_turn}) *x = in.get();
  r.stopped = in.get_flag();
  r.turned_most = in.get_text(), r.stopped_by = in.get_text();
  for (long n = in.get_count(); n > 0; --n) {
    Finding f{&finding_kind(in.get_text())};
    for (std::string* text : {&f.thing, &f.message, &f.advice, &f.unit, &f.place}) *text = in.get_text();
    f.value = in.get(), f.limit = in.get(), f.t = in.get();
    r.findings.push_back(std::move(f));
  }
  return r;
}

// To the last bit.
template <class Numbers>
std::string numbers_of(const Numbers& all) {
  std::string text;
  for (const double x : all) text += fmt::format(" {:.17g}", x);
  return text;
}

std::string numbers_of(const Pose& p) { return numbers_of(p.x) + numbers_of(p.q.coefficients()); }

std::string signature_of(const StepLoopOptions& options, const DynamicsOptions& dynamics) {
  const Stabilization& s = dynamics.stabilization;
  const Tolerance& t = options.tolerance;
  return fmt::format("; stabilization {}{}", static_cast<int>(s.kind),
                     numbers_of(std::array{s.alpha, s.beta, s.tolerance})) +
         "; tolerance" + numbers_of(std::array{t.relative, t.atol_x}) + "; step" +
         numbers_of(std::array{options.step}) + "; output" + numbers_of(std::array{options.output}) + "; output times" +
         numbers_of(options.output_times) + "; start limit" + numbers_of(std::array{options.start_limit});
}

// What must be the same when a run continues. Of links, forces and laws it has names and types, not their parameters.
std::string signature(const System& system, const Integrator& method, const Dynamics& dynamics,
                      const StepLoopOptions& options) {
  const IntegratorInfo info = method.info();
  std::string text = fmt::format("integrator {}{}, solver {}, formulation {}; {} slots", info.name,
                                 info.adaptive ? "" : " with fixed steps", dynamics.solver().name(),
                                 to_string(dynamics.options().formulation), system.n_slots());
  text += signature_of(options, dynamics.options());
  text += "; gravity" + numbers_of(system.gravity());
  for (const Body& body : system.bodies()) {
    const MassProperties& m = body.mass;
    text += "; body " + body.name + numbers_of(std::array{m.mass}) + ", centre" + numbers_of(m.center) + ", inertia" +
            numbers_of(m.J.reshaped());
  }
  for (const Marker& marker : system.markers())
    text += "; marker " + marker.name + " on " + marker.body->name + numbers_of(marker.local);
  for (const auto& link : system.links()) text += "; link " + link->name() + " " + std::string(link->type());
  for (const auto& force : system.forces()) text += "; force " + force->name() + " " + std::string(force->type());
  for (const ControlInput& input : system.control_inputs()) text += "; input " + input.name();
  for (const auto& own : system.auxiliaries()) text += "; state " + own->name();
  for (const auto& angle : system.counted_angles()) text += "; " + angle->name();
  return text;
}

}  // namespace

std::string first_difference(const std::string& saved, const std::string& now) {
  std::size_t from = 0;
  const auto at = [](const std::string& text, std::size_t k) { return k < text.size() ? text[k] : ';'; };
  for (std::size_t k = 0; k < std::max(saved.size(), now.size()) && at(saved, k) == at(now, k); ++k)
    if (at(saved, k) == ';') from = k + 2;
  const auto item = [&](const std::string& text) {
    return from < text.size() ? text.substr(from, text.find(';', from) - from) : std::string("nothing");
  };
  return fmt::format("it has \"{}\", the run has \"{}\"", item(saved), item(now));
}

void StepLoop::save(Snapshot& out) {
  if (!begun_) throw ModelError("a run that has not started cannot be saved; call run_until() first");
  if (parts_->due.what != Due::nothing)
    throw ModelError(
        "the run cannot be saved: its last step is not completed, because of an error or a call inside it; continue "
        "the run first");
  if (!method_->saves_all())
    throw ModelError(fmt::format(
        "integrator '{}' has a history that cannot be saved, so its runs have no checkpoints; use another one "
        "(--integrator)",
        method_->info().name));
  for (std::size_t i = 0; i < observers_.size(); ++i)
    if (const Observer& o = *observers_[i]; !o.saves_all())
      throw ModelError(
          fmt::format("observer {} ({}) has data that cannot be saved, so runs with it have no checkpoints; remove it",
                      i + 1, boost::core::demangle(typeid(o).name())));
  if (!dynamics_.has_current_coordinates(state_))
    throw ModelError("the run cannot be saved: the system has changed since its last step; continue the run first");
  const auto& parts = *parts_;
  out.put_text(signature(system(), *method_, dynamics_, options_));
  dynamics_.save_state(state_, out);
  const State& before = parts.before_change;
  const bool counts_on = state_.coordinates && before.coordinates == state_.coordinates;
  out.put(counts_on ? 1 : 0);
  if (counts_on) dynamics_.save_state(before, out);
  save_report(report_, out);
  for (const ControlInput& input : system().control_inputs()) out.put(input.value());
  out.put(stale_ ? 1 : 0), out.put(warned_of_turns_ ? 1 : 0), out.put(keeps_stop_ ? 1 : 0);
  parts.clock.save(out), parts.events.save(out), parts.contacts.save(out), parts.interval.save(out);
  Snapshot work;
  dynamics_.save(work);
  out.put_part(work);
  out.put(static_cast<double>(observers_.size()));
  for (std::size_t i = 0; i < observers_.size(); ++i) {
    Snapshot own;
    observer_code(*observers_[i], i, state_.t, [&] { observers_[i]->save(own); });
    out.put_part(own);
  }
}

void StepLoop::load(SnapshotReader in) {
  dynamics_.set_up();
  const std::string saved = in.get_text(), now = signature(system(), *method_, dynamics_, options_);
  if (saved != now) throw ModelError("the checkpoint belongs to another run: " + first_difference(saved, now));
  exclusively("load", [&] {
    State before = state_;
    Snapshot kept;
    const bool is_kept = begun_ && succeeds([&] { save(kept); });
    try {
      load_parts(in);
    } catch (...) {
      SnapshotReader back(kept);
      if (!begun_ && is_kept) succeeds([&] { back.get_text(), load_parts(back); });
      if (!begun_) state_ = std::move(before), dynamics_.to_slots(state_), report_ = {}, parts_->due = {};
      throw;
    }
  });
}

// Nothing is changed until all parts that hosts may have made otherwise are read.
void StepLoop::load_parts(SnapshotReader& in) {
  Parts& p = *parts_;
  State state, before;
  dynamics_.load_state(state, in);
  if (in.get_flag()) dynamics_.load_state(before, in);
  SimulationReport report = load_report(in);
  std::vector<double> inputs(system().control_inputs().size());
  for (double& value : inputs) value = in.get();
  const bool stale = in.get_flag(), warned = in.get_flag(), keeps = in.get_flag();
  SnapshotReader of_clock = in;
  Clock(p.clock).load(in), p.events.load(in);
  begun_ = false;
  state_ = std::move(state), p.before_change = std::move(before), report_ = std::move(report);
  for (std::size_t k = 0; k < inputs.size(); ++k) dynamics_.control_inputs()[k].set(inputs[k]);
  stale_ = stale, warned_of_turns_ = warned, keeps_stop_ = keeps;
  p.interval.start(state_);
  begin_inputs();
  p.clock.load(of_clock), p.clock.last().begin(state_.t);
  p.contacts.load(in), p.interval.load(state_, in);
  if (options_.output > 0 && !(p.clock.next_output() >= state_.t))  // between two steps earlier ones are past
    throw ModelError(
        "the saved outputs do not fit the time of the saved state: the checkpoint is damaged; use an older one");
  SnapshotReader work = in.get_part();
  p.change = {}, p.due = {}, p.along_laws.reset();
  p.started = 0;
  if (const long n = in.get_count(); n != static_cast<long>(observers_.size()))
    throw ModelError(
        fmt::format("the run was saved with {} observers and has {}; add the same observers in the same order", n,
                    observers_.size()));
  const Sample sample(dynamics_, state_, p.interval.report());
  for (; p.started < observers_.size(); ++p.started) {
    Observer& o = *observers_[p.started];
    SnapshotReader own = in.get_part();
    observer_code(o, p.started, state_.t, [&] { o.start(sample), o.load(own); });
    if (!own.at_end())
      throw ModelError(fmt::format(
          "observer {}: load() reads less than save() wrote; let it read everything in the same order", p.started + 1));
  }
  if (!in.at_end())
    throw ModelError("the checkpoint has more numbers than the run reads: it belongs to another run, or is damaged");
  dynamics_.restore(work);        // after all evaluations: the work to get here was counted before
  dynamics_.forget_rows(state_);  // steps that need them lay them out again
  begun_ = true;
}

}  // namespace lockstep
