// SPDX-License-Identifier: BSD-3-Clause
// Couplings where it gets harder: a carrier that moves, wheels that are bolted to shafts, turns counted through events
// and rejected steps, driven screws, a cam that its follower may leave. Closed forms.
#include <cmath>
#include <string>

#include <lockstep/author/registry.h>
#include <lockstep/couplings.h>
#include <lockstep/dynamics.h>
#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "framework/description/scene/system_of.h"
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/worst.h"

namespace couplings_test {

using namespace lockstep;

namespace {

constexpr double g = 9.81;

MassProperties wheel(double mass, double J) {
  return {mass, Vec3::Zero(), Vec3(0.6 * J, 0.6 * J, J).asDiagonal().toDenseMatrix()};
}
StepLoop simulate(Dynamics& dynamics, const std::string& method = "dop853", double tolerance = 1e-11, double step = 0,
                  double output = 0.05) {
  const Registry registry = builtin_registry();
  StepLoopOptions options;
  options.step = step, options.tolerance = {tolerance, 1e-2 * tolerance}, options.output = output;
  return StepLoop(dynamics, registry.integrators.make(method, {}, &registry, "method"), options);
}
/// Largest difference of a column from f(t).
template <class F>
double off(const Table& t, const char* column, F&& f) {
  double worst = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i)
    if (const double d = std::abs(t[column][i] - f(t["t"][i])); !(d <= worst)) worst = d;
  return worst;
}

}  // namespace

// Willis: sun, one planet and the arm, the ring on the ground: w_sun = (1 + zr/zs) w_arm, w_planet = (1 - zr/zp) w_arm.
TEST_CASE("a planetary gear rotates about a rotating arm", "[verification][joints]") {
  const bool merged = GENERATE(false, true), planar = GENERATE(false, true);
  CAPTURE(merged, planar);
  const double zs = 24, zp = 18, zr = 60, Js = 2e-3, Jp = 5e-4, Ja = 4e-3, m = 0.4, R = 0.1, T = 0.8;
  System system;
  Body& sun = system.add_body("sun", wheel(0.5, merged ? 0.7 * Js : Js));
  Body& planet = system.add_body("planet", wheel(m, Jp), {Vec3(R, 0, 0), Quat{}});
  Body& arm = system.add_body("arm", wheel(0.6, Ja));
  auto& of_sun = system.add<Revolute>("sun on arm", sun, arm, pose_at(Vec3::Zero()));
  auto& of_planet = system.add<Revolute>("planet on arm", planet, arm, pose_at(Vec3(R, 0, 0)));
  system.add<Revolute>("bearing", arm, system.ground(), pose_at(Vec3::Zero()));
  Marker& ring = system.add_marker("ring", system.ground());
  Marker& of_arm = system.add_marker("ring on arm", arm);
  system.add(std::make_unique<Gear>(across("outside", {of_sun, of_planet}), zp / zs));
  CoupledPairs inside = across("inside", {of_planet});
  inside.pairs.emplace_back(&ring, &of_arm);
  system.add(std::make_unique<Gear>(inside, zr / zp, Gear::Mesh::internal));
  if (merged) {  // the sun's inertia in two bodies that are bolted together
    Body& shaft = system.add_body("shaft", wheel(0.5, 0.3 * Js), {Vec3(0, 0, planar ? 0.0 : 0.2), Quat{}});
    system.add<Fixed>("bolt", shaft, sun, pose_at(Vec3::Zero()));
    system.set_merge(true);
  }
  system.add<TorqueMotor>("motor", system.add_marker("on sun", sun), system.add_marker("on ground", system.ground()),
                          {laws::constant(T)});
  if (planar) system.set_planar(Plane{2});
  Recorder recorder(system, {"sun.angle_z", "planet.angle_z", "arm.angle_z", "sun.omega_world_z", "energy.balance"});
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics);
  simulation.add_observer(recorder);
  simulation.run_until(2);
  const double ks = 1 + zr / zs, kp = 1 - zr / zp;
  const double alpha = T * ks / (Js * ks * ks + Jp * kp * kp + Ja + m * R * R);
  const auto turned = [&](double k) { return [=](double t) { return 0.5 * k * alpha * t * t; }; };
  const Table& t = recorder.table();
  CHECK(t["sun.angle_z"].back() > 20 * kTwoPi);
  CHECK(off(t, "sun.angle_z", turned(ks)) <= 1e-8);
  CHECK(off(t, "planet.angle_z", turned(kp)) <= 1e-8);
  CHECK(off(t, "arm.angle_z", turned(1)) <= 1e-8);
  CHECK(off(t, "sun.omega_world_z", [&](double x) { return ks * alpha * x; }) <= 1e-8);
  CHECK(off(t, "energy.balance", [](double) { return 0.0; }) <= 1e-9);
}

// Events are looked for inside of steps and the state is taken back to them; a jerk makes steps be rejected.
TEST_CASE("revolutions are counted once through events and rejected steps", "[verification][joints]") {
  const double lead = 0.05, J = 1e-3, m = 0.5;
  const auto torque = laws::law([](auto t) { return 0.2 * sin(4.0 * t) + 0.5 * exp(-400.0 * (t - 1.0) * (t - 1.0)); });
  System system;
  Body& nut = system.add_body("nut", wheel(m, J));
  system.add<Screw>("thread", nut, system.ground(), pose_at(Vec3::Zero()), lead);
  system.add<TorqueMotor>("motor", system.add_marker("on nut", nut), system.add_marker("on ground", system.ground()),
                          {torque});
  Recorder recorder(system, {"thread.angle", "nut.z", "thread.violation"});
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, "dopri5", 1e-9);
  int crossings = 0;
  for (int k = 1; k <= 12; ++k) {  // at every third turn the same torque goes on
    Event event;
    event.name = "turn " + std::to_string(k), event.once = false;
    event.value = [k, &nut, lead](const Sample& s) { return body_pose(nut, s.state).x[2] - 3.0 * lead * k; };
    event.change = [&crossings](State&) { ++crossings; };
    simulation.add_event(std::move(event));
  }
  simulation.add_observer(recorder);
  const SimulationReport& report = simulation.run_until(3);
  const Table& t = recorder.table();
  CHECK(report.rejected > 0);
  CHECK(crossings >= 12);
  CHECK(t["thread.angle"].back() > 30 * kTwoPi);
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    CHECK(std::abs(t["nut.z"][i] - lead / kTwoPi * t["thread.angle"][i]) <= 1e-10);
    CHECK(t["thread.violation"][i] <= 1e-10);
  }
  // the torque's first integral is the moment of momentum: (J + m (lead/2pi)^2) w
  double impulse = 0;
  constexpr int n = 30000;
  for (int i = 0; i < n; ++i) impulse += torque->at(3.0 * (i + 0.5) / n).y * 3.0 / n;
  const double c = lead / kTwoPi, w = simulation.state().v[5];
  CHECK(std::abs((J + m * c * c) * w - impulse) <= 1e-7);
}

// 500 rad/s by steps of 5 rad, the first one too; these methods turn a body by an exponential.
TEST_CASE("revolutions are counted from the first step on, also in long steps", "[verification][joints]") {
  const char* method = GENERATE("rattle2", "generalized_alpha", "semi_implicit_euler");
  CAPTURE(method);
  const double lead = 0.1, w = 500;
  System system;
  Body& nut = system.add_body("nut", wheel(1, 1e-3));
  nut.start = {Vec3(0, 0, lead / kTwoPi * w), Vec3(0, 0, w)};
  system.add<Screw>("thread", nut, system.ground(), pose_at(Vec3::Zero()), lead);
  Recorder recorder(system, {"thread.angle", "nut.z"});
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, method, 1e-9, 0.01, 0.1);
  simulation.add_observer(recorder);
  simulation.run_until(1);
  CHECK(off(recorder.table(), "thread.angle", [&](double t) { return w * t; }) <= 1e-9);
  CHECK(off(recorder.table(), "nut.z", [&](double t) { return lead / kTwoPi * w * t; }) <= 1e-10);
}

// phi = a t^2: the drive turns nut and mass, M = (J + m c^2) phi'' + m g c; the thread lifts, F = m (c phi'' + g).
TEST_CASE("a driven screw lifts", "[verification][joints]") {
  const double lead = -0.02, c = lead / kTwoPi, m = 3, J = 2e-3, a = 40;
  System system({.gravity = Vec3(0, 0, -g)});
  Body& nut = system.add_body("nut", wheel(m, J));
  auto& thread = system.add<Screw>("thread", nut, system.ground(), pose_at(Vec3::Zero()), lead);
  thread.drive(Axis::rz, laws::law([=](auto t) { return a * t * t; }));
  Recorder recorder(
      system, {"nut.z", "thread.angle", "thread.rate", "thread.lambda_thread", "thread.drive.torque_on_p_link_z"});
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics);
  simulation.add_observer(recorder);
  simulation.run_until(2);
  const Table& t = recorder.table();
  CHECK(off(t, "nut.z", [&](double x) { return c * a * x * x; }) <= 1e-11);
  CHECK(off(t, "thread.angle", [&](double x) { return a * x * x; }) <= 1e-10);
  CHECK(off(t, "thread.rate", [&](double x) { return 2 * a * x; }) <= 1e-9);
  CHECK(off(t, "thread.lambda_thread", [&](double) { return -m * (2 * a * c + g); }) <= 1e-8);
  CHECK(off(t, "thread.drive.torque_on_p_link_z", [&](double) { return 2 * a * (J + m * c * c) + m * g * c; }) <= 1e-9);
}

// A flat tappet on an eccentric circle: y = R + e sin(wt) while that falls less than freely, e w^2 sin(wt) < g; then it
// flies.
TEST_CASE("a tappet leaves its cam when it would have to be pulled", "[verification][joints]") {
  const double R = 0.05, e = 0.02, w = 30;
  System system({.gravity = Vec3(0, -g, 0)});
  Body& shaft = system.add_body("shaft", wheel(1, 1e-3));
  Body& tappet = system.add_body("tappet", wheel(0.2, 1e-4), {Vec3(0, R, 0), Quat{}});
  system.add<Revolute>("bearing", shaft, system.ground(), pose_at(Vec3::Zero())).drive(Axis::rz, laws::ramp(w));
  system.add<Prismatic>("guide", tappet, system.ground(), pose_at(Vec3(0, R, 0), Vec3(0, 1, 0)));
  tappet.start.v = Vec3(0, e * w, 0);
  auto& contact =
      system.add<CamFlat>("contact", system.add_marker("face", tappet), system.add_marker("cam", shaft),
                          laws::law([=](auto u) { return e * cos(u) + sqrt(R * R - e * e * sin(u) * sin(u)); }));
  contact.set_unilateral({});
  Recorder recorder(system, {"tappet.y", "contact.in_contact"});
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, "dop853", 1e-10, 0, 0.001);
  State start = system.start();
  start.v.segment<3>(6 * shaft.slot + 3) = Vec3(0, 0, w);
  simulation.set_state(start);
  simulation.add_observer(recorder);
  simulation.run_until(0.09);
  const double leaves = std::asin(g / (e * w * w)) / w, y0 = R + e * std::sin(w * leaves),
               v0 = e * w * std::cos(w * leaves);
  const auto flight = [&](double t) { return y0 + v0 * (t - leaves) - 0.5 * g * (t - leaves) * (t - leaves); };
  const auto rides = [&](double t) { return R + e * std::sin(w * t); };
  double lands = leaves + 1e-3;
  while (flight(lands) > rides(lands)) lands += 1e-5;
  REQUIRE(lands < 0.25);
  const Table& t = recorder.table();
  double worst = 0;
  int flying = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    const double time = t["t"][i];
    if (time > lands) continue;
    const bool flies = time > leaves;
    flying += flies;
    keep_worst(worst, std::abs(t["tappet.y"][i] - (flies ? flight(time) : rides(time))));
    if (std::abs(time - leaves) > 1e-4) CHECK(t["contact.in_contact"][i] == (flies ? 0 : 1));
  }
  CAPTURE(leaves, lands, worst);
  CHECK(flying > 20);
  CHECK(worst <= 1e-8);
}

TEST_CASE("joints and couplings from functions take nothing from the heap while they run", "[verification][joints]") {
  if (!allocations_are_counted()) return;
  const char* name = GENERATE("screw", "gear_train", "differential", "belt", "rack", "cam", "bead_on_curve",
                              "path_follower", "spatial_slider_crank", "hooke_double");
  CAPTURE(name);
  const Registry registry = builtin_registry();
  Scene scene = read_scene(std::string(paths::kScenes) + "/" + name + ".json");
  scene.run.integrator = {"rk4"}, scene.run.step = 1e-3;
  Mechanism m = build_mechanism(scene, registry);
  Dynamics dynamics(system_of(m), make_solver(m.run, registry));
  State start = m.system.start();
  assemble(dynamics, start, m.start_speeds);
  StepLoop simulation(dynamics, make_integrator(m.run, registry), {.step = 1e-3});
  simulation.set_state(start);
  for (int i = 0; i < 20; ++i) simulation.step();
  CHECK(allocations_of([&] {
          for (int i = 0; i < 100; ++i) simulation.step();
        }) == 0);
}

}  // namespace couplings_test
