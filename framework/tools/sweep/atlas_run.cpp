// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/sweep/atlas_run.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include <lockstep/sweep.h>
#include "framework/dynamics/simulate/step_rules.h"
#include "framework/foundation/support/thrown.h"
#include "framework/tools/rank/singular_watch.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

constexpr int kInstants = 50;  // at most

/// A run of a scene with its history.
struct Ran {
  History history;
  Audit audit;
  SimulationReport report;
  double length = 0, cpu = 0;
  long passed = 0;  // singular configurations, with unprojected stages
  bool given_up = false;
  std::string failure{};
};

Ran run_scene(const Scene& scene, const Registry& registry, const std::vector<double>& instants, double limit,
              const std::function<bool()>& go_on) {
  Ran ran;
  const std::function<double()> clock = thread_seconds;
  const double begin = clock();
  try {
    Mechanism m = build_mechanism(scene, registry);
    m.run.record.clear();
    const std::unique_ptr<Recorder> recorder = make_recorder(m);
    std::vector<Event> events = make_events(m, *recorder);
    HistoryObserver history(system_of(m), clock, ran.history);
    EnergyAudit audit(system_of(m), m.run.limits);
    Dynamics dynamics = make_dynamics(m, registry);
    State start = assembled_start(dynamics, m);
    ran.length = m.system.length();
    StepLoopOptions options = loop_options(m.run);
    options.output = 0, options.output_times = instants;
    SingularWatch singular(system_of(m));
    StepLoop loop(dynamics, make_integrator(m.run, registry), options);
    loop.add_observer(*recorder), loop.add_observer(history), loop.add_observer(audit);
    if (SingularWatch::is_needed(dynamics, start, loop.integrator().info())) loop.add_observer(singular);
    for (Event& event : events) loop.add_event(std::move(event));
    loop.set_state(std::move(start));
    loop.progress = [&](const State&) { return !(ran.given_up = clock() - begin > limit || !go_on()); };
    try {
      loop.run_until(m.run.until);
    } catch (const std::exception& error) {
      ran.failure = what_of(error);
    }
    ran.report = loop.report(), ran.audit = audit.result(), ran.passed = singular.n_passed();
  } catch (const std::exception& error) {
    ran.failure = what_of(error);
  }
  ran.cpu = clock() - begin;
  return ran;
}

// The times of `some` in a history that contains them all.
History at_instants(const History& all, const std::vector<double>& some) {
  History out;
  for (const double t : some) {
    const auto at = std::ranges::lower_bound(all, t - 1e-9 * std::max(1.0, t), {}, &Instant::t);
    if (at == all.end()) break;
    out.push_back(*at);
  }
  return out;
}

}  // namespace

std::vector<double> atlas_instants(const RunSettings& run, bool adaptive) {
  std::vector<double> all;
  const double apart =
      adaptive || !(run.step > 0) ? run.until / kInstants : std::ceil(run.until / run.step / kInstants) * run.step;
  for (int k = 0; k * apart <= run.until * (1 + 1e-12); ++k) all.push_back(std::min(k * apart, run.until));
  if (all.size() < 2) all.push_back(run.until);
  return all;
}

AtlasReference atlas_reference(const Scene& scene, const Registry& registry, const std::vector<double>& instants,
                               double limit, const std::function<bool()>& go_on) {
  AtlasReference out;
  Scene tight = scene;
  tight.run.step = 0, tight.run.max_steps = 0;
  tight.run.stabilization.kind = Stabilization::Kind::project;
  tight.run.stabilization.tolerance = std::min(tight.run.stabilization.tolerance, 1e-12);
  const auto with = [&](const char* method, double tolerance) {
    tight.run.integrator = {method, Value(Value::Object{}), {}};
    tight.run.tolerance = {tolerance, 1e-2 * tolerance};
    return run_scene(tight, registry, instants, limit, go_on);
  };
  for (const auto& [method, tolerance] :
       {std::pair("dop853", 1e-11), std::pair("radau5", 1e-10), std::pair("dop853", 1e-8), std::pair("radau5", 1e-7)}) {
    Ran ran = with(method, tolerance);
    if (ran.length == 0) {  // no run has begun
      out.invalid = true, out.reason = ran.failure;
      return out;
    }
    if (!ran.failure.empty() || ran.given_up || ran.history.size() != instants.size()) {
      out.reason = fmt::format("{} at {:g}: {}", method, tolerance, ran.given_up ? "too slow" : ran.failure);
      if (!go_on()) return out;
      continue;
    }
    if (ran.passed > 0) {  // on another branch it would not be a reference
      out.reason = fmt::format("{} at {:g}: passed singular configurations with unprojected stages", method, tolerance);
      continue;
    }
    out.agreement = difference(ran.history, with(method, 100 * tolerance).history, ran.length).position;
    out.size = size_of(ran.history, ran.length).position, out.length = ran.length;
    out.method = fmt::format("{} at {:g}", method, tolerance);
    out.history = std::move(ran.history);
    return out;
  }
  return out;
}

AtlasCell atlas_run(const Scene& scene, const Registry& registry, const AtlasReference& reference,
                    const std::vector<double>& instants, const AtlasLimits& limits, double limit,
                    const std::function<bool()>& go_on) {
  const Ran ran = run_scene(scene, registry, instants, limit, go_on);
  AtlasCell cell;
  cell.steps = ran.report.steps, cell.rejected = ran.report.rejected, cell.cpu = ran.cpu;
  cell.energy = ran.audit.imbalance_share(), cell.drift = ran.audit.violation;
  cell.passed = ran.passed;
  cell.error = difference(ran.history, at_instants(reference.history, instants), reference.length).position;
  if (!go_on()) return cell;
  if (ran.given_up || !ran.failure.empty()) {
    cell.outcome = ran.given_up ? AtlasOutcome::too_slow : AtlasOutcome::stopped;
    cell.reason = ran.given_up ? fmt::format("stopped after {:.2g} s of CPU time", ran.cpu) : ran.failure;
    cell.error = HUGE_VAL;
    return cell;
  }
  const bool wrong = ran.audit.is_wrong(), told = wrong || ran.passed > 0 || ran.report.largest_turn > kLongTurn;
  if (wrong)
    cell.reason = fmt::format("energy error {:.2g} %, constraint violation {:.2g} m", 100 * cell.energy, cell.drift);
  const double relative = reference.size > 0 ? cell.error / reference.size : 0;
  cell.outcome = relative <= limits.works && !wrong ? AtlasOutcome::works
                 : relative <= limits.wrong         ? AtlasOutcome::inaccurate
                 : told                             ? AtlasOutcome::wrong_told
                                                    : AtlasOutcome::wrong_untold;
  return cell;
}

const char* words_of(AtlasOutcome outcome) {
  constexpr const char* kWords[] = {"accurate", "inaccurate", "wrong (flagged)", "wrong (not flagged)", "failed",
                                    "too slow", "not tried",  "no reference",    "invalid scene"};
  return kWords[static_cast<std::size_t>(outcome)];
}

}  // namespace lockstep
