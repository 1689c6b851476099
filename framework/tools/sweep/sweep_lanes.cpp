// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/sweep/sweep_lanes.h"

#include <tuple>
#include <utility>

#include <lockstep/batch.h>
#include <lockstep/error.h>
#include <lockstep/integrators.h>
#include "framework/dynamics/tree/rows_in_plane.h"
#include "framework/mechanism/expression/expression.h"
#include "framework/tools/analysis/driven_scene.h"
#include "framework/tools/precision/work_precision.h"
#include "framework/tools/rank/doubts.h"
#include "framework/tools/scene_run/scene_run.h"
#include "framework/tools/sweep/watched_run.h"

namespace lockstep {
namespace {

const StepReport kNoReport{};  // a vectorised batch reports no steps

/// One run, at a fixed address.
struct Lane {
  Mechanism mechanism;
  std::unique_ptr<Recorder> recorder{};
  std::unique_ptr<EnergyAudit> audit{};  // none if laws do work, which lanes do not integrate
  std::unique_ptr<Doubts> doubts{};
  std::unique_ptr<Dynamics> dynamics{};
  State start{}, before{}, now{},
      inside{};            // before: of the last step, in slots; now, inside: as the dynamics take them
  QuinticOutput motion{};  // in the step, once a state inside it is asked for
  double violation = 0;  // largest |C| at an output, m
  std::vector<Finding> found{};
};

/// A step of a lane, whose states inside it are on the quintic through both ends.
class LaneStep final : public InsideStep {
 public:
  /// `last`: its end in slots, which `end` has as the dynamics take it.
  LaneStep(Lane& lane, const State& last, const Sample& end) : lane_(lane), last_(last), end_(end) {}
  double begin() const override { return lane_.before.t; }
  const Sample& end() const override { return end_; }
  bool has_states() const override { return true; }
  Sample at(double t) const override {
    if (!std::exchange(is_set_, true)) {
      const VecX a = accelerations(lane_.before), b = accelerations(last_);
      const VecX sd = (last_.s - lane_.before.s) / (last_.t - begin());
      lane_.motion.begin(lane_.before);
      lane_.motion.set(lane_.before, a, sd, last_, b, sd);
    }
    lane_.motion.at(t, lane_.inside);
    lane_.dynamics->to_formulation(lane_.inside);
    end_.forget();
    return {*lane_.dynamics, lane_.inside, kNoReport};
  }
  bool along_laws() const override { return false; }  // the error of joint coordinates limits it

 private:
  VecX accelerations(const State& in_slots) const {
    lane_.inside = in_slots;
    lane_.dynamics->to_formulation(lane_.inside);
    return Sample(*lane_.dynamics, lane_.inside, kNoReport).accelerations();
  }

  Lane& lane_;
  const State& last_;
  const Sample& end_;
  mutable bool is_set_ = false;
};

bool has_keys(const MethodSpec& typed) { return typed.keys.object() != nullptr && !typed.keys.object()->empty(); }

// The reason why a run with these settings cannot be in a vectorised batch; "" if it can.
std::string unsuited(const RunSettings& run) {
  const std::string& method = run.integrator.type;
  if ((method != "dop853" && method != "dopri5") || has_keys(run.integrator))
    return "vectorised runs need dop853 or dopri5 without keys";
  if (run.solver.type != "schur" || has_keys(run.solver)) return "vectorised runs need the solver schur without keys";
  if (run.stabilization.kind == Stabilization::Kind::baumgarte) return "Baumgarte stabilisation is not vectorised";
  if (run.nearly_redundant == NearlyRedundant::free || run.nearly_redundant == NearlyRedundant::held)
    return "vectorised runs need \"nearly_redundant\": \"auto\" or \"report\"";
  if (run.times.empty() && !(run.output > 0)) return "every step is recorded; give \"output\" or \"times\" to \"run\"";
  return {};
}

std::string unsuited(Mechanism& m) {
  if (!m.events.empty()) return "the scene has events";
  if (!m.run.require.empty()) return "the scene has requirements";
  for (const ChannelRequest& request : m.run.record) {
    for (const std::string& channel : expression::channels_in(request.channel))
      if (channel == "step" || channel == "rejected" || channel == "evaluations" || channel.starts_with("solver."))
        return "column \"" + request.column() + "\" exists only for single runs";
    if (make_channel(system_of(m), request.channel).of_motion)  // works add their states to the system
      return "column \"" + request.column() + "\" is of the whole motion";
  }
  return Copies::unsuited(system_of(m), m.run.formulation);
}

// Why two runs are not in one batch; "" if they may be.
std::string differing(const RunSettings& a, const RunSettings& b) {
  if (a.until != b.until) return "the runs have different end times";
  if (a.output != b.output || a.times != b.times) return "the runs have different output times";
  const auto method = [](const RunSettings& r) {
    return std::tuple(r.integrator.type, r.step, r.tolerance.relative, r.tolerance.atol_x, r.stabilization.kind,
                      r.stabilization.tolerance, r.formulation, r.max_steps);
  };
  return method(a) == method(b) ? "" : "the runs have different methods, steps or tolerances";
}

void prepare(Lane& lane, const Registry& registry) {
  Mechanism& m = lane.mechanism;
  lane.recorder = make_recorder(m);
  lane.recorder->find_extremes();
  if (!may_have_laws(m.system)) lane.audit = std::make_unique<EnergyAudit>(system_of(m), m.run.limits);
  lane.dynamics = std::make_unique<Dynamics>(system_of(m), make_solver(m.run, registry),
                                             DynamicsOptions{m.run.formulation, m.run.stabilization});
  lane.start = assembled_start(*lane.dynamics, m);
  lane.before = lane.start;
  lane.dynamics->to_slots(lane.before);
  lane.doubts = std::make_unique<Doubts>(records_reactions(m.run), m.run.tolerance.relative);
  const Sample first(*lane.dynamics, lane.start, kNoReport);
  lane.doubts->start(first);
  lane.recorder->start(first);
  if (lane.audit) lane.audit->start(first);
}

CopiesOptions options_of(const RunSettings& run, const Registry& registry) {
  CopiesOptions options;
  options.registry = &registry;
  options.integrator = run.integrator.type, options.tolerance = run.tolerance;
  options.max_step = run.step, options.max_steps = run.max_steps, options.stabilization = run.stabilization;
  options.formulation = run.formulation;
  return options;
}

std::vector<CopyReport> run_together(std::vector<std::unique_ptr<Lane>>& lanes, std::span<const double> times,
                                     const Registry& registry, const std::function<bool(double)>& go_on) {
  std::vector<System*> systems;
  std::vector<State> starts;
  for (const auto& lane : lanes) systems.push_back(&system_of(lane->mechanism)), starts.push_back(lane->start);
  Copies copies(systems, options_of(lanes.front()->mechanism.run, registry));
  const auto output = [&](int copy, std::size_t, const State& state) {
    Lane& lane = *lanes[copy];
    const FindingScope scope;
    lane.now = state;
    lane.dynamics->to_formulation(lane.now);
    const Sample sample(*lane.dynamics, lane.now, kNoReport);
    lane.recorder->output(sample);
    lane.doubts->output(sample);
    if (lane.audit) lane.audit->output(sample);
    if (const double now = lane.dynamics->violation(state); !(now <= lane.violation)) lane.violation = now;
    lane.found.insert(lane.found.end(), scope.found.begin(), scope.found.end());
  };
  const auto step = [&](int copy, const State& state, bool jumped) {
    Lane& lane = *lanes[copy];
    lane.now = state;
    lane.dynamics->to_formulation(lane.now);
    Sample sample(*lane.dynamics, lane.now, kNoReport);
    const FindingScope scope;
    if (jumped) {
      sample.cause = "the jump of a law";
      lane.recorder->jumped(sample);
    } else {
      lane.recorder->inside(LaneStep(lane, state, sample)), lane.recorder->step(sample);
    }
    if (lane.audit) jumped ? lane.audit->jumped(sample) : lane.audit->step(sample);
    lane.before = state;
    lane.found.insert(lane.found.end(), scope.found.begin(), scope.found.end());
  };
  return copies.run(starts, times, output, step, go_on);
}

// Energy and drift, of which the latter is computed at outputs.
void judge(const Lane& lane, SweepRun& run) {
  if (lane.audit) judge(lane.audit->result(), run);
  run.violation = lane.violation;
  run.drifted = !(run.violation <= lane.mechanism.run.limits.of(lane.mechanism.system.length()).violation);
  run.wrong = run.wrong || run.drifted;
}

}  // namespace

std::string unsuited_for_lanes(const Scene& scene, const Registry& registry) {
  if (std::string why = unsuited(scene.run); !why.empty()) return why;
  Mechanism mechanism = build_mechanism(scene, registry);
  return unsuited(mechanism);
}

std::vector<SweepRun> sweep_lanes(std::span<const Scene> scenes, const Registry& registry, const Table& like,
                                  const std::function<bool(double)>& go_on, std::vector<Table>* histories,
                                  std::string* why) {
  const auto apart = [&](const std::string& reason) {
    if (why != nullptr) *why = reason;
    return std::vector<SweepRun>();
  };
  const double begin = thread_seconds();
  std::vector<std::unique_ptr<Lane>> lanes;
  std::vector<double> times;
  std::vector<CopyReport> reports;
  bool broken_off = false;
  const auto goes_on = [&](double t) {
    broken_off = broken_off || (go_on && !go_on(t));
    return !broken_off;
  };
  try {
    for (const Scene& scene : scenes) {
      if (const std::string reason = unsuited(scene.run); !reason.empty()) return apart(reason);
      if (histories != nullptr && scene.run.at_jumps) return {};  // lanes have no rows at jumps
      if (!(scene.run.until > 0)) return apart("the end time is not positive");
      if (const std::string reason = differing(scene.run, scenes.front().run); !reason.empty()) return apart(reason);
      const FindingScope scope;
      lanes.push_back(std::make_unique<Lane>(Lane{build_mechanism(in_space(scene), registry)}));
      record_places(lanes.back()->mechanism);
      if (const std::string reason = unsuited(lanes.back()->mechanism); !reason.empty()) return apart(reason);
      prepare(*lanes.back(), registry);
      lanes.back()->found = scope.found;
      if (lanes.back()->recorder->table().names() != like.names()) return apart("the runs record different columns");
    }
    times = pose_times(scenes.front().run);
    std::erase_if(times, [&](double t) { return t > scenes.front().run.until; });
    if (lanes.empty() || times.empty()) return apart("there are no output times");
    reports = run_together(lanes, times, registry, goes_on);
  } catch (const Error& error) {
    return apart(times.empty() ? "a run in the batch failed" : fact_of(error));  // each alone, with its own reason
  }
  if (broken_off) {
    SweepRun broken;
    broken.broken_off = true;
    return std::vector<SweepRun>(scenes.size(), broken);
  }
  const double cpu = (thread_seconds() - begin) / static_cast<double>(lanes.size());
  std::vector<SweepRun> runs;
  for (std::size_t i = 0; i < lanes.size(); ++i) {
    Table* history = histories != nullptr ? &(*histories)[i] : nullptr;
    if (!reports[i].finished || !reports[i].error.empty()) {
      runs.push_back(sweep_run(
          scenes[i], registry, like, [&](const State& s) { return goes_on(s.t); }, history));
      runs.back().cpu += cpu;
      continue;
    }
    SweepRun run = recorded_run(*lanes[i]->recorder);
    run.steps = reports[i].steps, run.cpu = cpu;
    judge(*lanes[i], run);
    lanes[i]->doubts->take(reports[i].unmet);
    run.findings = std::move(lanes[i]->found);
    for (Finding& f : lanes[i]->doubts->findings(run.steps, lanes[i]->mechanism.run.until))
      run.findings.push_back(std::move(f));
    runs.push_back(std::move(run));
    if (history != nullptr) *history = lanes[i]->recorder->table();
  }
  return runs;
}

}  // namespace lockstep
