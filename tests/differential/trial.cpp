// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/system_of.h"
#include "tests/differential/trial.h"
#include "tests/support/worst.h"

#include <spdlog/spdlog.h>
#include <algorithm>
#include <cmath>
#include <limits>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/log.h>
#include <lockstep/scene.h>
#include <lockstep/step_loop.h>
#include <lockstep/sweep.h>
#include <lockstep/system.h>

namespace lockstep::differential {

namespace {

constexpr long kMaxSteps = 5000;

Snapshot snapshot(const System& system, const State& state) {
  Snapshot s;
  s.t = state.t;
  for (int k = 0;; ++k) {
    const std::string name = "b" + std::to_string(k);
    const auto found =
        std::find_if(system.bodies().begin(), system.bodies().end(), [&](const Body& b) { return b.name == name; });
    if (found == system.bodies().end()) return s;
    s.poses.push_back(body_pose(*found, state)), s.twists.push_back(body_twist(*found, state));
  }
}

class Camera : public Observer {
 public:
  void output(const Sample& sample) override { history.push_back(snapshot(sample.system(), sample.state)); }
  std::vector<Snapshot> history;
};

void run(const std::string& text, const Way& way, const Registry& registry, std::vector<Snapshot>& history) {
  Scene scene = scene_from_text(text, "random.json");
  scene.run.integrator = {way.integrator};
  scene.run.solver = {way.solver};
  scene.run.formulation = formulation_from(way.formulation);
  scene.run.stabilization.tolerance *= way.unit;
  if (way.baumgarte) scene.run.stabilization.kind = Stabilization::Kind::baumgarte;
  scene.run.tolerance = {way.tolerance, 0.01 * way.unit * way.tolerance};
  scene.run.step = way.step;
  Mechanism mechanism = build_mechanism(scene, registry);
  const RunSettings& settings = mechanism.run;
  Dynamics dynamics(system_of(mechanism), make_solver(settings, registry), {settings.formulation, settings.stabilization});
  State start = mechanism.system.start();
  assemble(dynamics, start, mechanism.start_speeds);
  StepLoop loop(
      dynamics, make_integrator(settings, registry),
      {.step = settings.step, .tolerance = settings.tolerance, .output = settings.output, .max_steps = kMaxSteps});
  loop.set_state(start);
  Camera camera;
  loop.add_observer(camera);
  loop.run_until(settings.until);
  history = std::move(camera.history);
  if (!way.and_back) return;
  State end = loop.state();
  dynamics.to_slots(end);
  end.v = -end.v;
  loop.set_state(end);
  loop.run_until(2 * settings.until);
  history.assign(1, snapshot(mechanism.system, loop.state()));
}

double angle(const Quat& a, const Quat& b) {
  const Quat d = conjugate(a) * b;
  return 2 * std::atan2(d.vec().norm(), std::abs(d.w));
}

}  // namespace

std::string Way::words() const {
  std::string text = integrator + ", " + solver + ", " + formulation + (baumgarte ? ", baumgarte" : "");
  text += step > 0 ? ", step " + std::to_string(step) + " s"
                   : ", tolerance " + std::to_string(std::log10(tolerance)) + " (log10)";
  return and_back ? text + ", and back" : text;
}

Trial compute(const std::string& scene, const Way& way) {
  static const Registry registry = [] {
    logger()->set_level(spdlog::level::off);  // random starts are full of warnings
    return builtin_registry();
  }();
  Trial trial;
  try {
    run(scene, way, registry, trial.history);
  } catch (const Error& error) {
    trial.refusal = error.what(), trial.kind = to_string(error.kind());
  } catch (const std::exception& error) {
    trial.refusal = error.what(), trial.kind = "foreign";
  } catch (...) {
    trial.refusal = "no exception", trial.kind = "foreign";
  }
  if (!trial.ok()) trial.history.clear();
  return trial;
}

std::vector<Snapshot> seen_back(std::vector<Snapshot> history, const Pose& frame, double length) {
  const Mat3 turn_back = rotation(conjugate(frame.q));
  for (Snapshot& s : history) {
    for (Pose& p : s.poses) p = {Vec3(turn_back * (p.x - frame.x) / length), conjugate(frame.q) * p.q};
    for (Twist& v : s.twists) v.v = turn_back * v.v / length;
  }
  return history;
}

double difference(const std::vector<Snapshot>& a, const std::vector<Snapshot>& b) {
  constexpr double kApart = std::numeric_limits<double>::infinity();
  if (a.empty() || a.size() != b.size()) return kApart;
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (std::abs(a[k].t - b[k].t) > 1e-12 || a[k].poses.size() != b[k].poses.size()) return kApart;
    for (std::size_t i = 0; i < a[k].poses.size(); ++i) {
      const double here =
          (a[k].poses[i].x - b[k].poses[i].x).norm() + angle(a[k].poses[i].q, b[k].poses[i].q) +
          0.1 * ((a[k].twists[i].v - b[k].twists[i].v).norm() + (a[k].twists[i].w - b[k].twists[i].w).norm());
      if (!std::isfinite(here)) return kApart;
      keep_worst(worst, here);
    }
  }
  return worst;
}

}  // namespace lockstep::differential
