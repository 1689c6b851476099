// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/sweep.h>

#include <cmath>
#include <optional>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/support/csv_cells.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/foundation/support/lines.h"
#include "framework/foundation/support/thrown.h"
#include "framework/tools/precision/work_precision.h"
#include "framework/tools/rank/cause.h"
#include "framework/tools/rank/doubts.h"
#include "framework/tools/rank/singular_watch.h"
#include "framework/tools/scene_run/requirements.h"
#include "framework/tools/scene_run/rows_at_jumps.h"
#include "framework/tools/scene_run/scene_run.h"
#include "framework/tools/sweep/same_steps.h"
#include "framework/tools/sweep/watched_run.h"

namespace lockstep {
namespace {

// The results of an audit.
void judge(const Audit& audit, SweepRun& run) {
  run.energy = audit.verdict(), run.imbalance = audit.imbalance_share();
  run.drifted = audit.drifted, run.violation = audit.violation;
  run.wrong = audit.is_wrong();
}

void simulate(Mechanism& m, Recorder& recorder, const Registry& registry, SweepRun& result,
              const std::function<bool(const State&)>& go_on, Observer* at_jumps, const RunWatch& watch) {
  std::vector<Event> events = make_events(m, recorder);
  EnergyAudit audit(system_of(m), m.run.limits);
  const std::unique_ptr<Requirements> requirements = make_requirements(m);
  Dynamics dynamics = make_dynamics(m, registry);
  State start = assembled_start(dynamics, m);
  std::unique_ptr<Integrator> method = make_integrator(m.run, registry);
  if (watch.steps != nullptr && method->info().adaptive && method->saves_all())
    method = std::make_unique<SameSteps>(std::move(method), *watch.steps);
  StepLoop sim(dynamics, std::move(method), loop_options(m.run));
  sim.add_observer(recorder);
  if (at_jumps != nullptr) sim.add_observer(*at_jumps);
  if (requirements) sim.add_observer(*requirements);
  sim.add_observer(audit);
  Doubts doubts(are_of_reactions(m.run.record), sim.integrator().info().adaptive ? m.run.tolerance.relative : 0.0);
  sim.add_observer(doubts);
  SingularWatch singular(system_of(m));
  if (SingularWatch::is_needed(dynamics, start, sim.integrator().info())) sim.add_observer(singular);
  if (watch.observer != nullptr) sim.add_observer(*watch.observer);
  for (Event& event : events) sim.add_event(std::move(event));
  const State started = start;
  sim.set_state(std::move(start));
  sim.progress = [&](const State& s) {
    result.broken_off = go_on && !go_on(s);
    return !result.broken_off;
  };
  const SimulationReport& report = sim.report();
  try {
    sim.run_until(m.run.until);
  } catch (const Error& error) {
    result.steps = report.steps;
    rethrow_of_run(system_of(m), sim, started, m.run.step, error);
  }
  result.steps = report.steps;
  if (!singular.passed().empty())
    result.passed = singular.n_passed(), result.first_passed = singular.passed().front().t;
  result.findings = doubts.findings(report.steps, sim.state().t);
  for (Finding& f : share_findings(system_of(m), m, {&started, &sim.state()})) result.findings.push_back(std::move(f));
  judge(audit.result(), result);
  for (Finding& f : broken_requirements(m, requirements.get()))
    result.findings.push_back(std::move(f)), result.wrong = true;
  if (report.stopped && !result.broken_off) result.status = "stopped by '" + report.stopped_by + "'";
}

std::string titled(const std::string& name, const std::string& unit) {
  return csv_cell(unit.empty() ? name : name + " [" + unit + "]");
}

}  // namespace

std::string SweepRun::outcome() const {
  if (failed) return "failed: " + status;
  std::string all = !wrong ? status : status == "ok" ? "wrong" : "wrong: " + status;
  if (passed > 0)
    all += "; passed " + std::to_string(passed) + " singular configuration" + (passed == 1 ? "" : "s") +
           " with unprojected stages, first at t = " + text::brief(first_passed) + " s";
  for (const Finding& f : findings)
    if (f.severity() >= Severity::doubt) all += (f.severity() == Severity::doubt ? "; doubtful: " : "; ") + f.text();
  return all;
}

std::string fact_of(const std::exception& error) {
  const auto* ours = dynamic_cast<const Error*>(&error);
  return first_line(ours == nullptr || std::isnan(ours->t) ? what_of(error) : ours->fact());
}

bool wrong_by(std::string_view outcome) {
  return outcome == "wrong" || outcome.starts_with("wrong: ") || outcome.starts_with("wrong; ");
}

Table recorded_columns(const Scene& scene, const Registry& registry) {
  Mechanism m = build_mechanism(scene, registry);
  record_places(m);
  return make_recorder(m)->table();
}

SweepRun sweep_run(const Scene& scene, const Registry& registry, const Table& like,
                   const std::function<bool(const State&)>& go_on, Table* history) {
  return watched_run(scene, registry, like, go_on, history, {});
}

SweepRun watched_run(const Scene& scene, const Registry& registry, const Table& like,
                     const std::function<bool(const State&)>& go_on, Table* history, const RunWatch& watch) {
  SweepRun result;
  result.status = "ok";
  const double begin = thread_seconds();
  const FindingScope scope;
  try {
    Mechanism m = build_mechanism(scene, registry);
    record_places(m);
    const std::unique_ptr<Recorder> recorder = make_recorder(m);
    recorder->find_extremes();
    // Rows at jumps are those of the history alone: results do not depend on whether it is kept.
    std::vector<double> last;
    bool jumps = false;
    recorder->on_row(
        [&](std::span<const double> row) {
          if (!jumps) last.assign(row.begin(), row.end());
        },
        true);
    std::optional<RowsAtJumps> at_jumps;
    if (history != nullptr && scene.run.at_jumps)
      at_jumps.emplace([&](const Sample& s) { jumps = true, recorder->output(s), jumps = false; }, *recorder);
    const auto end = [&] {
      if (history != nullptr) *history = recorder->table();
      if (watch.ended) watch.ended(m, recorder->table());
    };
    try {
      if (recorder->table().names() != like.names())
        throw ModelError(
            "it records other columns than the first run; list the same channels in \"record\" of \"run\"");
      if (m.run.until < 0) throw ModelError("the scene has no end time; add \"until\" to \"run\"");
      simulate(m, *recorder, registry, result, go_on, at_jumps ? &*at_jumps : nullptr, watch);
    } catch (...) {
      end();
      throw;
    }
    if (!last.empty()) {
      result.columns.assign(recorder->ranges().begin(), recorder->ranges().end());
      result.t = last.front();
      for (std::size_t k = 0; k < result.columns.size(); ++k) result.columns[k].last = last[k + 1];
    }
    end();
  } catch (const std::exception& error) {
    const auto* ours = dynamic_cast<const Error*>(&error);
    result.wrong = ours != nullptr && ours->thing.kind == "requirement";  // of numbers
    result.failed = !result.wrong;
    if (result.failed)
      result.status = fact_of(error);
    else
      result.findings.push_back({&finding::requirement_broken, "", fact_of(error)});
  }
  result.findings.insert(result.findings.begin(), scope.found.begin(), scope.found.end());
  result.cpu = thread_seconds() - begin;
  return result;
}

std::string sweep_header(const std::vector<Variable>& variables, const Table& columns) {
  std::string line = "run";
  for (const Variable& v : variables) line += "," + titled(v.path, v.unit);
  const Column& time = columns.columns().front();
  line += "," + titled(time.name + " final", time.unit);
  for (std::size_t k = 1; k < columns.n_columns(); ++k)
    for (const char* what : {" final", " min", " max"})
      line += "," + titled(columns.columns()[k].name + what, columns.columns()[k].unit);
  return line + ",energy,imbalance,violation [m],steps,cpu [s],status\n";
}

std::string row_begin(long run, const std::vector<Variable>& variables, const std::vector<std::size_t>& choice) {
  std::string line = std::to_string(run);
  for (std::size_t k = 0; k < variables.size(); ++k) line += "," + csv_cell(plain_text(variables[k].values[choice[k]]));
  return line;
}

std::string sweep_row(long run, const std::vector<Variable>& variables, const std::vector<std::size_t>& choice,
                      const Table& columns, const SweepRun& result) {
  std::string line = row_begin(run, variables, choice);
  const std::size_t n = columns.n_columns() - 1;
  if (result.failed || result.columns.size() != n) {
    line += std::string(1 + 3 * n, ',');
  } else {
    line += "," + text::number(result.t);
    for (const ColumnRange& c : result.columns)
      for (const double x : {c.last, c.least, c.most}) line += "," + text::number(x);
  }
  const bool judged = !result.failed && !result.energy.empty();
  line += "," + result.energy + "," + (judged ? text::number(result.imbalance) : "") + "," +
          (result.failed ? "" : text::number(result.violation));
  return line + "," + std::to_string(result.steps) + "," + text::number(result.cpu) + "," + csv_cell(result.outcome()) +
         "\n";
}

}  // namespace lockstep
