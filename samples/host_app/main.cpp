// SPDX-License-Identifier: BSD-3-Clause
// A host program on an installed lockstep: plugins, a law of its own, an observer, a stop, every type of error.
#include <cmath>
#include <cstdio>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include "errors.h"

using namespace lockstep;

namespace {

/// A law of the host's own: the speed rises smoothly (as a cosine) within `time` and stays.
class SoftStart final : public MotionLaw {
 public:
  SoftStart(double speed, double time) : w_(speed), T_(time) {}
  LawValue at(double t) const override {
    if (t <= 0) return {};
    if (t >= T_) return {w_ * (t - T_ / 2), w_, 0};
    const double k = kPi / T_;
    return {w_ / 2 * (t - std::sin(k * t) / k), w_ / 2 * (1 - std::cos(k * t)), w_ / 2 * k * std::sin(k * t)};
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    for (const double t : {0.0, T_})
      if (t0 < t && t < t1) out.push_back(t);
  }
  static TypeInfo info() {
    return {"soft_start",
            "the speed rises smoothly and stays",
            {{"speed", Form::number, Unit::any, kRequired, "at the end", {}, LawQuantity::rate},
             {"time", Form::number, Unit::time, kRequired, "until then"}}};
  }
  static LawPtr<MotionLaw> make(const Params& p) {
    if (!(p.number("time") > 0)) p.refuse("time", "is " + text::brief(p.number("time")) + " s; it must be above zero");
    return std::make_shared<SoftStart>(p.number("speed"), p.number("time"));
  }

 private:
  double w_, T_;
};

/// Looks at every accepted step and keeps the highest place of a body.
class Highest final : public Observer {
 public:
  explicit Highest(const Body& body) : body_(body) {}
  void start(const Sample& s) override { step(s); }
  void step(const Sample& s) override {
    const double y = s.state.slot_pose(body_.slot).x.y();
    if (y > highest) highest = y, when = s.state.t;
    ++looks;
  }
  double highest = -1e300, when = 0;
  long looks = 0;

 private:
  const Body& body_;
};

// A cam and its follower in C++; the joint comes from a plugin, the law of the shaft is the host's. Ends where the
// follower has risen by 15 mm, which the closed form knows: 0.01 (1 - cos psi) = 0.015.
bool cam_in_cpp(const Registry& registry) {
  System sys({.gravity = {0, -9.81, 0}});
  Body& cam = sys.add_body("cam", shapes::cylinder(1.0, 0.05, 0.02));
  Body& follower = sys.add_body("follower", shapes::box(0.3, {0.02, 0.1, 0.02}), {{0, 0.05, 0}, {}});
  auto& shaft = sys.add<Revolute>("shaft", cam, sys.ground(), pose_at({0, 0, 0}));
  sys.add<Prismatic>("guide", follower, sys.ground(), pose_at({0, 0.05, 0}, Vec3::UnitY()));
  Marker& tip = sys.add_marker_at("tip", follower, {{0, 0.05, 0}, {}});
  Marker& disc = sys.add_marker_at("disc", cam, {{0, 0, 0}, axis_angle(Vec3::UnitZ(), kPi / 2)});
  sys.add(registry.links.make("cam_follower", Attachment{"ride", {{&tip, &disc}}},
                              Params{{"base", 0.05}, {"lift", 0.02}}, &registry, "host_app"));
  shaft.drive(Axis::rz, registry.laws.make("soft_start", Params{{"speed", 4.0}, {"time", 0.5}}, &registry, "host_app"));

  Dynamics dynamics(sys, registry.solvers.make("schur", Params{}, &registry, "host_app"));
  State start = sys.start();
  assemble(dynamics, start);
  StepLoop run(dynamics, registry.integrators.make("dopri5", Params{}, &registry, "host_app"));
  run.set_state(start);
  Highest highest(follower);
  run.add_observer(highest);
  run.add_event({.name = "15 mm",
                 .value = [&](const Sample& s) { return s.state.slot_pose(follower.slot).x.y() - 0.065; },
                 .stop = true});
  const SimulationReport& report = run.run_until(10.0);

  const double psi = std::acos(-0.5), expected = psi / 4.0 + 0.25;  // soft_start: psi = 4 (t - 0.25) after 0.5 s
  std::printf("C++: stopped by '%s' at t = %.9f s (closed form %.9f s), %ld looks, highest %.6f m\n",
              report.stopped_by.c_str(), run.state().t, expected, highest.looks, highest.highest);
  return report.stopped && std::abs(run.state().t - expected) < 1e-6 && std::abs(highest.highest - 0.065) < 1e-6;
}

// A slider-crank from a file that uses the host's law and a plugin's; ends with the crank at a full turn.
bool crank_from_scene(const Registry& registry) {
  Simulation run(read_mechanism(HOST_APP_SCENE, registry));
  run.add_event({.name = "a full turn", .at = 1.25, .stop = true});
  run.run();

  const Table& table = run.table();
  const double angle = table["A.rz"].back(), x = table["piston.x"].back();
  std::printf("scene: %zu rows, at t = %.3f s the crank stands at %.9f rad, the piston at %.9f m\n", table.n_rows(),
              run.state().t, angle, x);
  return std::abs(angle - kTwoPi) < 1e-6 && std::abs(x - 0.8) < 1e-6;
}

}  // namespace

int main() {
  bool right = false;
  std::string words;
  const std::string error = handled(
      [&] {
        Registry registry = builtin_registry();  // a value: another one knows nothing of what comes into this one
        for (const char* plugin : {"cam_follower", "bump"})
          std::printf("loaded %s\n", load_plugin(registry, plugin).c_str());
        registry.laws.add<SoftStart>();
        right = cam_in_cpp(registry);
        right = crank_from_scene(registry) && right;
        right = provoke_them_all(registry) == 0 && right;
      },
      words);
  if (!error.empty()) std::fprintf(stderr, "%s: %s\n", error.c_str(), words.c_str());
  return right ? 0 : 1;
}
