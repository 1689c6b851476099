// SPDX-License-Identifier: BSD-3-Clause
#include "tests/stability/invariance.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <utility>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/joints.h>
#include <lockstep/log.h>
#include <lockstep/scene.h>
#include <lockstep/step_loop.h>
#include "framework/description/scene/system_of.h"
#include "framework/tools/rank/doubts.h"

namespace lockstep::invariance {

namespace {

void shuffle(Value* list, unsigned seed) {
  std::minstd_rand random(seed);
  Value::List& items = *list->list();
  for (std::size_t k = items.size(); k > 1; --k) std::swap(items[k - 1], items[random() % k]);
}

Value* member(Value& object, const char* key) { return const_cast<Value*>(std::as_const(object).find(key)); }

void exchange_ends(Value& joint) {
  const std::string type = joint.find("type") ? *joint.find("type")->text() : "";
  if ((type == "revolute" || type == "prismatic") && joint.find("p") && joint.find("s"))
    std::swap(*member(joint, "p"), *member(joint, "s"));
}

Scene written(const Case& c, const View& view, const Way& way) {
  Scene scene = set_in_scene(read_scene(c.path), c.set, builtin_registry());
  for (const char* key : {"bodies", "joints", "links"})
    if (Value* const list = member(scene.root, key)) {
      if (view.exchanged && key[0] != 'b')
        for (Value& joint : *list->list()) exchange_ends(joint);
      if (view.order != 0) shuffle(list, view.order);
    }
  scene.written = Value();
  RunSettings& run = scene.run;
  run.integrator = {way.integrator};
  if (way.stages != "auto") run.integrator.keys = Value::object({{"stages", way.stages}});
  run.solver = {way.solver};
  run.formulation = formulation_from(way.formulation);
  run.tolerance = {way.tolerance, 0.01 * way.tolerance};
  run.stabilization.tolerance *= view.length;
  run.step = 0, run.times.clear(), run.until = c.until, run.output = c.until / 10;
  return way.in_space ? in_space(std::move(scene)) : scene;
}

constexpr const char* kCompany = "company";

void add_company(System& system) {
  system.setup();
  const double length = 400 * system.length();
  const Vec3 g = system.gravity(), down = g.norm() > 0 ? g.normalized() : Vec3::UnitX();
  Body& body = system.add_body(kCompany, shapes::rod(1, Vec3::Zero(), length * down));
  system.add<Revolute>("pivot of the company", body, system.ground(), pose_at(Vec3::Zero(), down.unitOrthogonal()));
}

// What is in the world, or has a unit of length, of mechanisms without forces of their own.
void place(System& system, const View& view) {
  const Mat3 A = rotation(view.frame.q);
  const double l = view.length;
  const auto seen = [&](const Pose& pose) {
    const Pose there = view.frame * pose;
    return Pose{l * there.x, there.q};
  };
  for (const Body& body : system.bodies()) {
    if (body.name == "ground") continue;
    Body& moved = system.body(body.name);
    moved.home = seen(body.home), moved.start.v = l * A * body.start.v;
    moved.mass.center *= l, moved.mass.J *= l * l;
  }
  for (const Marker& marker : system.markers()) {
    Pose& local = system.marker(marker.name).local;
    local = marker.body == &system.ground() ? seen(local) : Pose{l * local.x, local.q};
  }
  system.set_gravity(l * A * system.gravity());
  system.changed();
}

// By name, as the order differs.
Instant instant(const System& system, const State& state, const View& view) {
  std::map<std::string, const Body*> bodies;
  for (const Body& body : system.bodies())
    if (!body.fixed && body.name != "ground" && body.name != kCompany) bodies[body.name] = &body;
  Instant now{state.t, {}, {}};
  const Mat3 back = rotation(conjugate(view.frame.q));
  for (const auto& [name, body] : bodies) {
    const Pose pose = body_pose(*body, state);
    const Twist twist = body_twist(*body, state);
    now.poses.push_back({Vec3(back * (pose.x / view.length - view.frame.x)), conjugate(view.frame.q) * pose.q});
    now.twists.push_back({Vec3(back * twist.v / view.length), twist.w});
  }
  return now;
}

class Camera : public Observer {
 public:
  Camera(const View& view, std::vector<Instant>& history) : view_(view), history_(history) {}
  void output(const Sample& sample) override { history_.push_back(instant(sample.system(), sample.state, view_)); }

 private:
  const View& view_;
  std::vector<Instant>& history_;
};

double angle(const Quat& a, const Quat& b) {
  const Quat d = conjugate(a) * b;
  return 2 * std::atan2(d.vec().norm(), std::abs(d.w));
}

}  // namespace

std::string Way::words() const {
  return fmt::format("{}{}, {}, {}{}, {:.0e}", formulation, in_space ? "" : " in its plane", solver, integrator,
                     stages == "auto" ? "" : ":" + stages, tolerance);
}

Trace follow(const Case& c, const View& view, const Way& way, double faster) {
  static const Registry registry = builtin_registry();
  logger()->set_level(spdlog::level::off);
  Trace motion;
  try {
    Mechanism m = build_mechanism(written(c, view, way), registry);
    System& system = system_of(m);
    if (view.company) add_company(system);
    if (way.in_space) place(system, view);
    const RunSettings& run = m.run;
    Dynamics dynamics(system, make_solver(run, registry), {run.formulation, run.stabilization});
    dynamics.set_up();
    State start = m.system.start();
    for (VelocityTarget& target : m.start_speeds) target.value *= view.exchanged ? -1 : 1;
    assemble(dynamics, start, m.start_speeds, m.assembly);
    start.v *= 1 + faster;
    StepLoop loop(dynamics, make_integrator(run, registry),
                  {.tolerance = run.tolerance, .output = run.output, .max_steps = 200000});
    Camera camera(view, motion.history);
    loop.set_state(start);
    loop.add_observer(camera);
    Doubts doubts(false, run.tolerance.relative);
    loop.add_observer(doubts);
    motion.steps = loop.run_until(run.until).steps;
    for (const Finding& f : doubts.findings(motion.steps, run.until)) motion.doubts += f.text() + "\n";
  } catch (const Error& error) {
    motion.refusal = error.what();
  }
  return motion;
}

double fastest(const std::vector<Instant>& history) {
  double most = 0;
  for (const Instant& now : history)
    for (const Twist& v : now.twists) most = std::max({most, v.v.norm(), v.w.norm()});
  return most;
}

double difference(const std::vector<Instant>& a, const std::vector<Instant>& b) {
  constexpr double kApart = std::numeric_limits<double>::infinity();
  if (a.empty() || a.size() != b.size()) return kApart;
  const double per_rate = 1 / std::max(10.0, fastest(a));
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (std::abs(a[k].t - b[k].t) > 1e-12 || a[k].poses.size() != b[k].poses.size()) return kApart;
    for (std::size_t i = 0; i < a[k].poses.size(); ++i) {
      const double here =
          (a[k].poses[i].x - b[k].poses[i].x).norm() + angle(a[k].poses[i].q, b[k].poses[i].q) +
          per_rate * ((a[k].twists[i].v - b[k].twists[i].v).norm() + (a[k].twists[i].w - b[k].twists[i].w).norm());
      if (!std::isfinite(here)) return kApart;
      worst = std::max(worst, here);
    }
  }
  return worst;
}

}  // namespace lockstep::invariance
