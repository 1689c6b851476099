// SPDX-License-Identifier: BSD-3-Clause
// The catalogue of joints in motion: scenes and mechanisms whose motion and forces are known in closed form, or by one
// equation of motion that the test integrates itself.
#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/couplings.h>
#include <lockstep/detail/phi_function.h>
#include <lockstep/dynamics.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "framework/mechanism/links/cam_functions.h"
#include "tests/support/catch.h"
#include "tests/support/link_bench.h"
#include "tests/support/paths.h"
#include "tests/support/run_scene.h"
#include "tests/support/worst.h"

namespace catalogue_test {

using namespace lockstep;

namespace {

constexpr double g = 9.81;

SceneRun run_of(const std::string& name, const std::function<void(RunSettings&)>& change = {},
                const std::function<void(Scene&)>& describe = {}) {
  return run_scene(scene_path(name), change, describe);
}
/// Largest difference of a column from f(t), over the whole history.
double off(const Table& t, const char* column, const std::function<double(double)>& f) {
  double worst = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i)
    if (const double d = std::abs(t[column][i] - f(t["t"][i])); !(d <= worst)) worst = d;
  return worst;
}
std::function<double(double)> steady(double a) {
  return [a](double) { return a; };
}
std::function<double(double)> falling(double a) {  // from rest
  return [a](double t) { return 0.5 * a * t * t; };
}
std::function<double(double)> rising(double a) {
  return [a](double t) { return a * t; };
}

/// s and s' at the times, from s'' = f(s, s'), by an integrator that is not ours.
template <class F>
std::vector<std::vector<double>> solved(F f, double s, double sd, const std::vector<double>& times) {
  using namespace boost::numeric::odeint;
  using X = std::vector<double>;
  X x{s, sd};
  std::vector<X> all;
  integrate_times(
      make_controlled(1e-13, 1e-13, runge_kutta_fehlberg78<X>()),
      [&](const X& y, X& d, double) { d[0] = y[1], d[1] = f(y[0], y[1]); }, x, times.begin(), times.end(), 1e-3,
      [&](const X& y, double) { all.push_back(y); });
  return all;
}

/// A simulation by dop853 at 1e-11 that is looked at at times.
struct Run {
  Dynamics dynamics;
  StepLoop simulation;
  static std::unique_ptr<Integrator> dop853() {
    RunSettings settings;
    settings.integrator = {"dop853"};
    return make_integrator(settings, builtin_registry());
  }
  explicit Run(System& system)
      : dynamics(system, std::make_unique<SchurSolver>()),
        simulation(dynamics, dop853(), {.tolerance = {1e-11, 1e-13}}) {
    State start = system.start();
    assemble(dynamics, start, {});
    simulation.set_state(start);
  }
  const State& at(double t) {
    if (t > simulation.state().t) simulation.run_until(t);
    return simulation.state();
  }
};

const MassProperties kBody{1.0, Vec3::Zero(), Vec3(0.01, 0.01, 0.01).asDiagonal()};

}  // namespace

// T on the cage, -M on the right wheel: J1 a1 = -l, J2 a2 = M2 - l, Jc a3 = T + 2 l, a1 + a2 = 2 a3.
TEST_CASE("a differential shares torque and speed", "[verification][joints]") {
  const char* solver = GENERATE("schur", "dense", "sparse", "block");
  CAPTURE(solver);
  const Table t = run_of("differential", [&](RunSettings& r) { r.solver = {solver}; }).table;
  const double J = 0.5 * 8 * 0.3 * 0.3, Jc = 0.05, T = 30, M = -5;
  const double l = (M / J - 2 * T / Jc) / (2 / J + 4 / Jc);
  CHECK(off(t, "left", falling(-l / J)) <= 1e-9);
  CHECK(off(t, "right", falling((M - l) / J)) <= 1e-9);
  CHECK(off(t, "cage", falling((T + 2 * l) / Jc)) <= 1e-9);
  CHECK(off(t, "left_d", rising(-l / J)) <= 1e-9);
  CHECK(off(t, "lambda", steady(l)) <= 1e-10);
  CHECK(off(t, "balance", steady(0)) <= 1e-10);
}

// Load, drum and large pulley, small pulley: m + J_large/r^2 + J_small (R/(r1))^2/r^2 seen from the load.
TEST_CASE("a belt hoist falls with its equivalent mass", "[verification][joints]") {
  const char* solver = GENERATE("schur", "block");
  const Table t = run_of("belt", [&](RunSettings& r) { r.solver = {solver}; }).table;
  const double m = 3, r = 0.08, r1 = 0.1, r2 = 0.25, J1 = 0.5 * 1.5 * r1 * r1, J2 = 0.5 * 6 * r2 * r2;
  const double a = m * g / (m + (J2 + J1 * (r2 / r1) * (r2 / r1)) / (r * r));
  CHECK(off(t, "drop", falling(a)) <= 1e-10);
  CHECK(off(t, "drop_d", rising(a)) <= 1e-10);
  CHECK(off(t, "large", falling(-a / r)) <= 1e-9);
  CHECK(off(t, "small", falling(-a / r * r2 / r1)) <= 1e-9);
  CHECK(off(t, "rope", steady(m * (g - a))) <= 1e-9);                    // m a = m g - l
  CHECK(off(t, "belt", steady(J1 * (a / r) * (r2 / r1) / r1)) <= 1e-9);  // J1 a1 = -l r1
  CHECK(off(t, "balance", steady(0)) <= 1e-10);
}

// g sin 20/(1 + J/(m r^2)); the teeth push back with the rest.
TEST_CASE("a pinion rolls down its rack", "[verification][joints]") {
  const bool planar = GENERATE(false, true);
  const SceneRun run = run_of("rack", {}, [&](Scene& s) {
    s.root.object()->push_back({"planar", Value(planar ? "z" : "off"), {}});
  });
  CHECK(run.n_velocities == (planar ? 3 : 6));
  const double angle = 20 * kPi / 180, m = 2, r = 0.15, a = g * std::sin(angle) / 1.5;
  const Table& t = run.table;
  CHECK(off(t, "x", falling(a * std::cos(angle))) <= 1e-10);
  CHECK(off(t, "y", falling(-a * std::sin(angle))) <= 1e-10);
  CHECK(off(t, "phi", falling(-a / r)) <= 1e-9);
  CHECK(off(t, "along", steady(m * a - m * g * std::sin(angle))) <= 1e-9);
  CHECK(off(t, "normal", steady(m * g * std::cos(angle))) <= 1e-9);
  CHECK(off(t, "balance", steady(0)) <= 1e-10);
}

// s'' = g b/(a^2 + b^2), so all is known; the wire's force too.
TEST_CASE("a bead runs down a helix", "[verification][joints]") {
  const Table t = run_of("bead_on_curve").table;
  const double a = 0.4, b = 0.3, m = 0.1, sdd = g * b / (a * a + b * b);
  const auto s = falling(sdd);
  const auto at = [&](double time, double c, double d) {  // m (a (c s'' ... )): force = m (acceleration + g z)
    const double sd = sdd * time;
    return m * a * (c * sdd + d * sd * sd);
  };
  CHECK(t["s"].back() > 4 * kTwoPi);
  CHECK(off(t, "s", s) <= 1e-8);
  CHECK(off(t, "s_d", rising(sdd)) <= 1e-8);
  CHECK(off(t, "x", [&](double x) { return a * std::cos(s(x)); }) <= 1e-8);
  CHECK(off(t, "y", [&](double x) { return a * std::sin(s(x)); }) <= 1e-8);
  CHECK(off(t, "z", [&](double x) { return -b * s(x); }) <= 1e-8);
  CHECK(off(t, "Fx", [&](double x) { return at(x, -std::sin(s(x)), -std::cos(s(x))); }) <= 1e-6);
  CHECK(off(t, "Fy", [&](double x) { return at(x, std::cos(s(x)), -std::sin(s(x))); }) <= 1e-6);
  CHECK(off(t, "Fz", [&](double) { return m * (g - b * sdd); }) <= 1e-8);
  CHECK(off(t, "balance", steady(0)) <= 1e-9);
}

// (m p^2 + m (R - h)^2 + Jx) s'' = -m g (R - h) sin s: a pendulum that goes over.
TEST_CASE("a car on a corkscrew is a pendulum", "[verification][joints]") {
  const Table t = run_of("path_follower").table;
  const double m = 500, p = 0.8, l = 2 - 0.2, J = 120, M = m * (p * p + l * l) + J;
  const auto truth = solved([&](double s, double) { return -m * g * l * std::sin(s) / M; }, 0, 5, t["t"]);
  REQUIRE(truth.size() == t.n_rows());
  double s = 0, sd = 0, x = 0, angle = 0, seat = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double way = truth[i][0], speed = truth[i][1];
    const double rate = -m * g * l * std::sin(way) / M;
    keep_worst(s, std::abs(t["s"][i] - way)), keep_worst(sd, std::abs(t["s_d"][i] - speed));
    keep_worst(x, std::abs(t["x"][i] - p * way)), keep_worst(x, std::abs(t["z"][i] + 2 * std::cos(way)));
    keep_worst(angle, std::abs(t["angle"][i] - way));
    // the mass centre goes round at l: z = -l cos s
    keep_worst(seat, std::abs(t["seat"][i] - m * (g + l * (std::sin(way) * rate + std::cos(way) * speed * speed))));
  }
  CHECK(t["s"].back() > kTwoPi);
  CAPTURE(s, sd, x, angle, seat);
  CHECK(s <= 1e-8);
  CHECK(sd <= 1e-8);
  CHECK(x <= 1e-8);
  CHECK(angle <= 1e-8);
  CHECK(seat <= 1e-8 * m * g * 5);
  CHECK(off(t, "balance", steady(0)) <= 1e-9 * m * g * 4);
}

// On a circle with the axes turned as far as the way goes round: a pendulum of length R + c, inertia J.
TEST_CASE("a follower of a circle is a pendulum, on any start and in the plane", "[verification][joints]") {
  const bool planar = GENERATE(false, true);
  const double R = 0.7, J = 0.01, m = 1.0, start = 2.9;
  System system({.gravity = Vec3(0, -g, 0)});
  const auto path = laws::translation([=](auto s) { return std::array{R * sin(s), -R * cos(s), 0.0 * s}; });
  const auto turn = laws::rotation([](auto s) { return QuatT<decltype(s)>{cos(0.5 * s), 0.0 * s, 0.0 * s, sin(0.5 * s)}; });
  Body& body = system.add_body("bob", kBody, {path->at(start).x, turn->at(start).q});
  system.add<PathFollower>("rail", system.add_marker("p", body), system.add_marker("s", system.ground()),
                           {.path = path, .turn = turn, .near = start});
  if (planar) system.set_planar(Plane{2});
  system.setup();
  Run run(system);
  std::vector<double> times;
  for (int i = 0; i <= 40; ++i) times.push_back(0.1 * i);
  const auto truth =
      solved([&](double s, double) { return -m * g * R * std::sin(s) / (m * R * R + J); }, start, 0, times);
  double worst = 0;
  for (std::size_t i = 0; i < times.size(); ++i)
    keep_worst(worst, (run.at(times[i]).slot_pose(body.slot).x - path->at(truth[i][0]).x).norm());
  CAPTURE(planar, worst);
  CHECK(worst <= 1e-8);
}

// Parabola y = x^2/2, ellipse: m (c'.c') s'' + m c'.c'' s'^2 = -m g c_y'.
TEST_CASE("a bead on a wire in a plane satisfies its single equation of motion", "[verification][joints]") {
  struct Wire {
    const char* name;
    LawPtr<TranslationLaw> path;
    double start, speed;
  };
  const auto parabola = laws::translation([](auto s) { return std::array{1.0 * s, 0.5 * s * s, 0.0 * s}; });
  const auto ellipse = laws::translation([](auto s) { return std::array{1.2 * cos(s), 0.5 * sin(s), 0.3 * cos(s)}; });
  const auto wire = GENERATE_COPY(Wire{"parabola", parabola, 1.3, 0}, Wire{"ellipse, swinging", ellipse, 0.4, 0},
                                  Wire{"ellipse, going round", ellipse, 0.0, 4});
  CAPTURE(wire.name);
  System system({.gravity = Vec3(0, -g, 0)});
  const TranslationValue begin = wire.path->at(wire.start);
  Body& bead = system.add_particle("bead", 0.3, begin.x);
  bead.start.v = begin.v * wire.speed;
  system.add<PointOnCurve>("wire", system.add_marker("p", bead), system.add_marker("s", system.ground()), wire.path,
                           wire.start);
  system.setup();
  Run run(system);
  std::vector<double> times;
  for (int i = 0; i <= 30; ++i) times.push_back(0.1 * i);
  const auto truth = solved(
      [&](double s, double sd) {
        const TranslationValue c = wire.path->at(s);
        return (-g * c.v[1] - c.v.dot(c.a) * sd * sd) / c.v.squaredNorm();
      },
      wire.start, wire.speed, times);
  double worst = 0;
  for (std::size_t i = 0; i < times.size(); ++i)
    keep_worst(worst, (run.at(times[i]).slot_pose(bead.slot).x - wire.path->at(truth[i][0]).x).norm());
  CAPTURE(worst);
  CHECK(worst <= 1e-8);
}

namespace {

/// A cam that turns at `speed` about z, and a follower that slides along y above it, its face turned by `tilt`.
struct Camshaft {
  System system{{.gravity = Vec3(0, -g, 0)}};
  Body& shaft = system.add_body("shaft", kBody);
  Body& follower;
  Marker *P, *S;
  Camshaft(double speed, const Pose& start) : follower(system.add_body("follower", kBody, start)) {
    auto& bearing = system.add<Revolute>("bearing", shaft, system.ground(), pose_at(Vec3::Zero()));
    bearing.drive(Axis::rz, laws::ramp(speed));
    system.add<Prismatic>("guide", follower, system.ground(), pose_at(start.x, Vec3(0, 1, 0)));
    P = &system.add_marker("P", follower), S = &system.add_marker("S", shaft);
  }
};

/// A circle of radius R with its centre e from the axis, at psi = 0.
LawPtr<MotionLaw> eccentric(double R, double e) {
  return laws::law([=](auto u) { return e * cos(u) + sqrt(R * R - e * e * sin(u) * sin(u)); });
}

}  // namespace

// The roller's centre is R + r from the circle's centre: y = e sin(wt) + sqrt((R + r)^2 - (x - e cos(wt))^2).
TEST_CASE("a roller on an eccentric circle is a slider-crank", "[verification][joints]") {
  const double R = 0.05, e = 0.02, r = 0.015, w = 7, x = 0.012, l = R + r;
  const auto height = laws::law([=](auto t) {
    const auto c = x - e * cos(w * t);
    return e * sin(w * t) + sqrt(l * l - c * c);
  });
  const bool planar = GENERATE(false, true);
  Camshaft cam(w, {Vec3(x, height->at(0).y, 0), Quat{}});
  cam.system.add<CamRoller>("contact", *cam.P, *cam.S, eccentric(R, e), r);
  if (planar) cam.system.set_planar(Plane{2});
  cam.system.setup();
  Run run(cam.system);
  double y = 0, v = 0, push = 0;
  for (int i = 0; i <= 60; ++i) {
    const double t = 0.05 * i;
    const State s = run.at(t);
    const LawValue h = height->at(t);
    keep_worst(y, std::abs(s.slot_pose(cam.follower.slot).x[1] - h.y));
    keep_worst(v, std::abs(s.v[6 * cam.follower.slot + 1] - h.yd));
    // the contact pushes along the line of centres: its share along y is m (y'' + g)
    const double along = (h.y - e * std::sin(w * t)) / l;
    const Evaluated& values = run.dynamics.evaluate(s);
    double lambda = 0;
    for (const RowEntry& entry : values.rows.entries)
      if (entry.m == 1) lambda = values.lambda[entry.first_row];
    keep_worst(push, std::abs(-lambda * along - (h.ydd + g)));
  }
  CAPTURE(planar, y, v, push);
  CHECK(y <= 1e-11);
  CHECK(v <= 1e-9);
  CHECK(push <= 1e-8);
}

// A flat face on the same circle: its height is R + e sin(wt), wherever it is guided.
TEST_CASE("a flat face on an eccentric circle moves as a sine", "[verification][joints]") {
  const double R = 0.05, e = 0.02, w = 7;
  const double aside = GENERATE(0.0, 0.01);
  Camshaft cam(w, {Vec3(aside, R, 0), Quat{}});
  cam.system.add<CamFlat>("contact", *cam.P, *cam.S, eccentric(R, e));
  cam.system.setup();
  Run run(cam.system);
  double y = 0, v = 0, push = 0;
  for (int i = 0; i <= 60; ++i) {
    const double t = 0.05 * i;
    const State s = run.at(t);
    keep_worst(y, std::abs(s.slot_pose(cam.follower.slot).x[1] - (R + e * std::sin(w * t))));
    keep_worst(v, std::abs(s.v[6 * cam.follower.slot + 1] - e * w * std::cos(w * t)));
    const Evaluated& values = run.dynamics.evaluate(s);
    double lambda = 0;
    for (const RowEntry& entry : values.rows.entries)
      if (entry.m == 1) lambda = values.lambda[entry.first_row];
    keep_worst(push, std::abs(-lambda - (g - e * w * w * std::sin(w * t))));
  }
  CAPTURE(aside, y, v, push);
  CHECK(y <= 1e-11);
  CHECK(v <= 1e-9);
  CHECK(push <= 1e-8);
}

// Splined profiles: every sample against a search along the profile; whatever integrates it.
TEST_CASE("followers of splined cams agree with a search", "[verification][joints]") {
  struct Way {
    const char* integrator;
    double step, limit;
  };
  const auto way = GENERATE(Way{"dop853", 0, 1e-10}, Way{"rk4", 1e-3, 2e-10}, Way{"radau5", 2e-3, 2e-10},
                            Way{"generalized_alpha", 1e-3, 2e-10});
  CAPTURE(way.integrator);
  LawPtr<MotionLaw> one, two;
  const SceneRun run = run_of(
      "cam",
      [&](RunSettings& r) {
        r.integrator = {way.integrator}, r.step = way.step;
        if (way.step > 0) r.tolerance.relative = 1e-8;
      },
      [&](Scene& s) {
        const Registry registry = builtin_registry();
        Mechanism m = build_mechanism(s, registry);
        one =
            phi_of<RollerOnCam>(static_cast<const CamRoller&>(m.system.link("contact_1")).function()).profile.radius();
        two = phi_of<FaceOnCam>(static_cast<const CamFlat&>(m.system.link("contact_2")).function()).profile.radius();
      });
  const Table& t = run.table;
  REQUIRE(t.n_rows() == 241);
  double roller = 0, face = 0;
  for (std::size_t i = 0; i < t.n_rows(); i += 3) {
    const double phi = t["phi"][i];
    const auto point = [&](const MotionLaw& r, double u) {
      const double a = u - kTwoPi * std::floor(u / kTwoPi);
      return Eigen::Vector2d(r.at(a).y * std::cos(u + phi), r.at(a).y * std::sin(u + phi));
    };
    const Eigen::Vector2d centre(0, t["y_1"][i]);
    const double away = testing::least([&](double u) { return (point(*one, u) - centre).norm(); }, 0, kTwoPi).second;
    const double top = -testing::least([&](double u) { return -point(*two, u)[1]; }, 0, kTwoPi).second;
    keep_worst(roller, std::abs(away - 0.015)), keep_worst(face, std::abs(top - t["y_2"][i]));
  }
  CAPTURE(roller, face);
  CHECK(roller <= way.limit);
  CHECK(face <= way.limit);
  // the work of the drive is what followers and shaft carry: torque against the power of pushes
  double power = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i)
    keep_worst(power, std::abs(t["torque"][i] * 12 - 0.3 * (t["y_1_dd"][i] + g) * t["y_1_d"][i] -
                               0.2 * (t["y_2_dd"][i] + g) * t["y_2_d"][i]));
  CHECK(power <= (std::string(way.integrator) == "generalized_alpha" ? 1e-2 : 1e-7));
}

}  // namespace catalogue_test
