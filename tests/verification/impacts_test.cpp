// SPDX-License-Identifier: BSD-3-Clause
// One-sided links against closed forms: bounces, their energy and their end, rests and releases.
#include <boost/math/special_functions/ellint_1.hpp>
#include <cmath>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/lockstep.h>
#include "framework/description/scene/system_of.h"
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/worst.h"

namespace impacts_test {

using namespace lockstep;

namespace {

constexpr double kG = 9.81;

/// A particle of 0.5 kg above a plane.
struct Ball {
  System system{{{0, 0, -kG}}};
  Body* body;
  PointOnPlane* floor;
  Ball(double height, Unilateral unilateral) {
    body = &system.add_particle("ball", 0.5, {0, 0, height});
    floor = &system.add<PointOnPlane>("floor", system.add_marker("P", *body), system.add_marker("S", system.ground()));
    floor->set_unilateral(unilateral);
  }
};

/// Height of a ball that falls from h and bounces with e for ever.
double bouncing(double h, double e, double t) {
  double v = std::sqrt(2 * kG * h), from = v / kG;
  if (t < from) return h - 0.5 * kG * t * t;
  for (int k = 0; k < 2000; ++k) {
    v *= e;
    const double flight = 2 * v / kG;
    if (t < from + flight) return v * (t - from) - 0.5 * kG * (t - from) * (t - from);
    from += flight;
  }
  return 0;
}

/// p(t) = (0, 0, 0.02 sin 20 t).
class AlongZ final : public TranslationLaw {
 public:
  TranslationValue at(double t) const override {
    const double w = 20, a = 0.02;
    return {{0, 0, a * std::sin(w * t)}, {0, 0, a * w * std::cos(w * t)}, {0, 0, -a * w * w * std::sin(w * t)}};
  }
};

struct Way {
  std::string method;
  double step, tolerance, error;
};

StepLoop simulate(Dynamics& dynamics, const Way& way, double output = 0) {
  const Registry registry = builtin_registry();
  StepLoopOptions options;
  options.step = way.step, options.tolerance = {way.tolerance, 1e-2 * way.tolerance}, options.output = output;
  return StepLoop(dynamics, registry.integrators.make(way.method, {}, &registry, "method"), options);
}

}  // namespace

TEST_CASE("a ball bounces to rest at the instant of the closed form", "[verification][impacts]") {
  const double h = 1, e = 0.8, fall = std::sqrt(2 * h / kG), end = fall * (1 + e) / (1 - e);
  const auto way = GENERATE(Way{"dop853", 0, 1e-10, 1e-9}, Way{"dopri5", 0, 1e-8, 1e-8}, Way{"rk4", 1e-2, 1e-6, 1e-9},
                            Way{"radau5", 0, 1e-8, 1e-8}, Way{"rattle2", 1e-2, 1e-6, 1e-9},
                            Way{"generalized_alpha", 1e-3, 1e-6, 1e-8});
  CAPTURE(way.method);
  Ball ball(h, {e, 1e-4});
  Recorder recorder(ball.system,
                    {"ball.z", "floor.in_contact", "floor.impact_loss", "energy.balance", "floor.lambda_z"});
  Dynamics dynamics(ball.system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, way, 0.05);
  simulation.add_observer(recorder);
  const SimulationReport& report = simulation.run_until(6);
  const Table& t = recorder.table();
  double worst = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i) keep_worst(worst, std::abs(t["ball.z"][i] - bouncing(h, e, t["t"][i])));
  CHECK(worst < way.error);
  // bounces that leave more than the rest speed, and the last
  const int bounces = static_cast<int>(std::log(1e-4 / std::sqrt(2 * kG * h)) / std::log(e)) + 1;
  CHECK(std::abs(report.impacts - bounces) <= (way.error > 1e-6 ? 1 : 0));
  CHECK(end < 4.1);
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    if (t["t"][i] < end - 1e-3) CHECK(t["floor.in_contact"][i] == 0);
    if (t["t"][i] > end + 1e-3) {
      CHECK(t["floor.in_contact"][i] == 1);
      CHECK(t["floor.lambda_z"][i] == Approx(-0.5 * kG));
    }
  }
  CHECK(t["floor.impact_loss"].back() == Approx(0.5 * kG * h).epsilon(way.error > 1e-6 ? 1e-2 : 1e-7));
  if (way.error < 1e-6)
    for (const double b : t["energy.balance"]) CHECK(std::abs(b) < 1e-8);
}

// A slender rod let go level hits a stop at the bottom. With W^2 = 3 g/(2 l): w = 2 W k at the bottom, k =
// sin(amplitude /2), a quarter of a swing takes K(k)/W; after the n-th hit k_n = e^n sin(45 deg).
TEST_CASE("a pendulum on a stop keeps e^2 of its energy a bounce, at the instants of the closed form",
          "[verification][impacts]") {
  const double l = 0.8, m = 1.2, e = 0.7, W = std::sqrt(1.5 * kG / l);
  const auto way = GENERATE(Way{"dop853", 0, 1e-11, 1e-9}, Way{"rk4", 1e-3, 1e-6, 1e-8}, Way{"radau5", 0, 1e-9, 1e-7});
  const bool planar = GENERATE(false, true);
  CAPTURE(way.method, planar);
  System system({{0, -kG, 0}});
  if (planar) system.set_planar(Plane{2});
  Body& rod = system.add_body(
      "rod", MassProperties{
                 m,
                 {l / 2, 0, 0},
                 Vec3(1e-4, 1, 1).cwiseProduct(Vec3(1, m * l * l / 12, m * l * l / 12)).asDiagonal().toDenseMatrix()});
  auto& hinge = system.add<Revolute>("hinge", rod, system.ground(), pose_at(Vec3::Zero()));
  auto& stop = system.add<TurnStop>("stop", system.marker("hinge.P"), system.marker("hinge.S"),
                                    {.limit = -kPi / 2, .low = true});
  stop.set_unilateral({e, 1e-3});
  const Channel energy = make_channel(system, "energy.total"), balance = make_channel(system, "energy.balance");
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, way);
  const auto now = [&](const Channel& c) { return c.value(Sample(dynamics, simulation.state(), {})); };
  balance.memory->start(Sample(dynamics, simulation.state(), {}));
  double k = std::sin(kPi / 4), hit = boost::math::ellint_1(k) / W;
  const double lowest = -m * kG * l / 2;
  for (int n = 0; n < 5; ++n) {
    CAPTURE(n);
    simulation.run_until(hit - way.error);
    CHECK(simulation.report().impacts == n);
    simulation.run_until(hit + way.error);
    CHECK(simulation.report().impacts == n + 1);
    CHECK(now(energy) - lowest == Approx(std::pow(e, 2 * (n + 1)) * m * kG * l / 2).epsilon(10 * way.error));
    CHECK(std::abs(now(balance)) < way.error);
    k *= e;
    hit += 2 * boost::math::ellint_1(k) / W;
  }
  CHECK(hinge.row_count() == 5);
}

// From the bottom with v^2 = 3.5 g l a bob goes slack where cos(angle) = (2 g l - v^2)/(3 g l), at 120 degrees; then it
// flies, until the rope is taut again and takes what goes along it.
TEST_CASE("a rope goes slack, and taut again with a jerk", "[verification][impacts]") {
  const double l = 1, v0 = std::sqrt(3.5 * kG * l);
  const auto way = GENERATE(Way{"dop853", 0, 1e-11, 1e-8}, Way{"rk4", 1e-3, 1e-6, 1e-8});
  System system({{0, 0, -kG}});
  Body& bob = system.add_particle("bob", 0.4, {0, 0, -l});
  bob.start.v = {v0, 0, 0};
  auto& rope = system.add<Distance>("rope", system.add_marker("P", bob), system.add_marker("S", system.ground()), l);
  rope.set_unilateral({0, 1e-3, true});
  Recorder recorder(system, {"bob.x", "bob.z", "bob.vx", "bob.vz", "rope.in_contact", "rope.lambda_phi",
                             "rope.impact_loss", "energy.balance"});
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, way, 0.01);
  simulation.add_observer(recorder);
  simulation.run_until(1.6);
  const Table& t = recorder.table();
  const double v = std::sqrt(0.5 * kG * l), c = -0.5, s = std::sqrt(0.75);  // at 120 degrees: v^2 = g l/2
  const Vec3 from(s * l, 0, -c * l), u(v * c, 0, v * s);
  std::size_t first = 0;
  while (t["rope.in_contact"][first] == 1) ++first;
  REQUIRE(first > 10);
  // the instant, by the level of vx, which is constant from there
  std::size_t row = first;
  CHECK(t["bob.vx"][row] == Approx(u[0]).epsilon(way.error));
  const double since = (u[2] - t["bob.vz"][row]) / kG;  // of the flight, at this row
  for (; row < t.n_rows() && t["rope.in_contact"][row] == 0; ++row) {
    const double dt = since + t["t"][row] - t["t"][first];
    CHECK(std::abs(t["bob.x"][row] - from[0] - u[0] * dt) < way.error);
    CHECK(std::abs(t["bob.z"][row] - from[2] - u[2] * dt + 0.5 * kG * dt * dt) < way.error);
  }
  REQUIRE(row < t.n_rows());
  // |from + u dt + g dt^2/2| = l: the terms up to dt^2 cancel at the slack point, dt^3 (g.u... ) leaves dt = -4 u.g/g^2
  const double taut = 4 * u[2] / kG;
  CHECK(since + t["t"][row - 1] - t["t"][first] < taut);
  CHECK(since + t["t"][row] - t["t"][first] > taut);
  const Vec3 x = from + u * taut - Vec3(0, 0, 0.5 * kG * taut * taut), w = u - Vec3(0, 0, kG * taut);
  CHECK(x.norm() == Approx(l).epsilon(1e-12));
  CHECK(t["rope.impact_loss"][row] == Approx(0.5 * 0.4 * std::pow(w.dot(x) / l, 2)).epsilon(1e-7));
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    CHECK(t["rope.lambda_phi"][i] >= -1e-9);  // a rope pulls
    CHECK(std::abs(t["energy.balance"][i]) < 1e-8);
  }
}

// A weight is lifted by a force that grows as k t: it leaves the floor at t0 = m g/k, then z = k (t - t0)^3/(6 m).
TEST_CASE("a weight leaves its floor at the time given by the force on it", "[verification][impacts]") {
  const double k = 4, m = 0.5, t0 = m * kG / k;
  const auto way =
      GENERATE(Way{"dop853", 0, 1e-10, 1e-9}, Way{"rk4", 1e-2, 1e-6, 1e-9}, Way{"generalized_alpha", 1e-3, 1e-6, 1e-5});
  CAPTURE(way.method);
  Ball ball(0, {});
  const Marker& lift = ball.system.marker("P");
  ball.system.add(function_force("lift", {&lift}, [k, &lift](const Inputs& in, WrenchSum& out) {
    out.force(lift.body->slot, {0, 0, k * in.t}, in.slot(lift.body->slot).x);
  }));
  Recorder recorder(ball.system, {"ball.z", "floor.in_contact", "floor.lambda_z"});
  Dynamics dynamics(ball.system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, way, 0.01);
  simulation.add_observer(recorder);
  CHECK(simulation.run_until(2).impacts == 0);
  const Table& t = recorder.table();
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    const double late = t["t"][i] - t0;
    CHECK(t["floor.in_contact"][i] == (late < 0 ? 1 : 0));
    CHECK(t["floor.lambda_z"][i] == Approx(late < 0 ? k * late : 0).margin(1e-6));
    CHECK(std::abs(t["ball.z"][i] - (late < 0 ? 0 : k * late * late * late / (6 * m))) < way.error);
  }
}

// Between two walls without gravity: speeds V e^n, the n-th flight takes gap/(V e^n).
TEST_CASE("a slider rattles between two stops", "[verification][impacts]") {
  const double low = -0.2, high = 0.3, V = 2, e = 0.9;
  const auto way =
      GENERATE(Way{"dop853", 0, 1e-10, 1e-9}, Way{"rk4", 1e-2, 1e-6, 1e-9}, Way{"rattle2", 0.03, 1e-6, 1e-9});
  System system;
  Body& slider = system.add_body("slider", MassProperties{2.0, Vec3::Zero(), Mat3::Identity()});
  slider.start.v = {0, 0, V};
  system.add<Prismatic>("guide", slider, system.ground(), pose_at(Vec3::Zero()));
  Marker &P = system.marker("guide.P"), &S = system.marker("guide.S");
  system.add<SlideStop>("low", P, S, {.axis = 2, .limit = low, .low = true}).set_unilateral({e, 1e-3});
  system.add<SlideStop>("high", P, S, {.axis = 2, .limit = high, .low = false}).set_unilateral({e, 1e-3});
  Recorder recorder(system, {"slider.z", "energy.balance"});
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, way, 0.05);
  simulation.add_observer(recorder);
  struct Jumps final : Observer {
    long n = 0;
    void jumped(const Sample&) override { ++n; }
  } jumps;
  simulation.add_observer(jumps);
  simulation.run_until(4);
  CHECK(simulation.report().impacts == 9);
  CHECK(jumps.n == simulation.report().impacts);  // nothing else acts
  const Table& t = recorder.table();
  const auto place = [&](double time) {
    double from = 0, x = 0, v = V;
    for (;; v *= -e) {
      const double wall = v > 0 ? high : low, flight = (wall - x) / v;
      if (time < from + flight) return x + v * (time - from);
      from += flight, x = wall;
    }
  };
  double worst = 0, imbalance = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    keep_worst(worst, std::abs(t["slider.z"][i] - place(t["t"][i])));
    keep_worst(imbalance, std::abs(t["energy.balance"][i]));
  }
  CHECK(worst < way.error);
  CHECK(imbalance < 1e-9);
}

namespace {

/// A rod of length 1 along x that falls flat; supports under the x given.
struct FlatRod {
  System system{{{0, 0, -kG}}};
  Body* rod;
  double J = 0.1;
  FlatRod(const std::vector<double>& supports, Unilateral unilateral, double height = 0.5) {
    rod = &system.add_body("rod", MassProperties{1.5, Vec3::Zero(), Vec3(0.01, J, J).asDiagonal().toDenseMatrix()},
                           {{0, 0, height}, {}});
    int n = 0;
    for (const double x : supports) {
      const std::string name = "support " + std::to_string(n++);
      system
          .add<PointOnPlane>(name, system.add_marker(name + ".P", *rod, {{x, 0, 0}, {}}),
                             system.add_marker(name + ".S", system.ground()))
          .set_unilateral(unilateral);
    }
  }
};

}  // namespace

// One support at a: the impulse p of Cd+ = -e Cd- is (1 + e) V/(1/m + a^2/J). Two, both hit at one instant: the rod
// leaves flat.
TEST_CASE("a rod is hit at one end, and at both at one instant", "[verification][impacts]") {
  const double V = std::sqrt(2 * kG * 0.5), fall = V / kG, e = 0.6, a = 0.5, m = 1.5;
  for (const bool both : {false, true}) {
    CAPTURE(both);
    FlatRod it(both ? std::vector<double>{-a, a} : std::vector<double>{a}, {e, 1e-3});
    Dynamics dynamics(it.system, std::make_unique<SchurSolver>());
    StepLoop simulation = simulate(dynamics, {"dop853", 0, 1e-11, 0});
    simulation.run_until(fall + 1e-9);
    CHECK(simulation.report().impacts == 1);
    const Twist now = body_twist(*it.rod, simulation.state());
    const double p = both ? m * (1 + e) * V : (1 + e) * V / (1 / m + a * a / it.J);
    CHECK(now.v[2] == Approx(-V + p / m).epsilon(1e-7));
    CHECK(now.w[1] == Approx(both ? 0 : -a * p / it.J).margin(1e-6));
  }
}

TEST_CASE("a rod on three supports rests on those that push", "[verification][impacts]") {
  FlatRod it({-0.5, 0.1, 0.5}, {}, 0.0);
  it.rod->mass.center = {0.3, 0, 0};  // between the second and the third: the first would have to pull
  it.system.changed();
  Recorder recorder(it.system, {"rod.z", "support 0.lambda_z", "support 1.lambda_z", "support 2.lambda_z",
                                "support 0.in_contact", "energy.balance"});
  Dynamics dynamics(it.system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, {"dop853", 0, 1e-9, 0}, 0.1);
  simulation.add_observer(recorder);
  simulation.run_until(1);
  const Table& t = recorder.table();
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    CHECK(std::abs(t["rod.z"][i]) < 1e-9);
    CHECK(t["support 0.lambda_z"][i] <= 1e-9);
    CHECK(t["support 1.lambda_z"][i] <= 1e-9);
    CHECK(t["support 2.lambda_z"][i] <= 1e-9);
    CHECK(t["support 0.lambda_z"][i] + t["support 1.lambda_z"][i] + t["support 2.lambda_z"][i] ==
          Approx(-1.5 * kG).epsilon(1e-9));
  }
}

namespace {

/// A cube that is thrown on a floor, with a support under each corner, and friction there.
std::string cube(double mu) {
  std::string markers, links, forces;
  for (int k = 0; k < 8; ++k) {
    const std::string n = std::to_string(k), comma = k > 0 ? ", " : "";
    const auto edge = [&](int bit) { return std::string(k >> bit & 1 ? "0.1" : "-0.1"); };
    markers +=
        R"(, {"name": "m)" + n + R"(", "body": "cube", "at": [)" + edge(0) + ", " + edge(1) + ", " + edge(2) + "]}";
    links += comma + R"({"name": "c)" + n + R"(", "type": "point_on_plane", "p": "m)" + n +
             R"(", "s": "floor", "unilateral": {"restitution": 0.4}})";
    forces += comma + R"({"name": "f)" + n + R"(", "type": "joint_friction", "link": "c)" + n + R"(", "mu": )" +
              std::to_string(mu) + R"(, "smoothing_speed": 0.01})";
  }
  return R"({"lockstep": 1, "gravity": [0, 0, -9.81], "bodies": [{"name": "cube", "box": {"mass": 1, "size": [0.2, 0.2, 0.2]},
    "position": [0, 0, 0.6], "orientation": {"angles": [0.3, 0.2, 0.1], "sequence": "xyz"}, "velocity": [0.5, 0, 0],
    "omega_world": [1, 2, 0]}], "markers": [{"name": "floor", "body": "ground"})" +
         markers + R"(], "links": [)" + links + R"(], "forces": [)" + forces + "]}";
}

}  // namespace

// No closed form, but an end: it lies flat, still (or sliding on at the speed that nothing takes), and the books agree.
TEST_CASE("a cube that is thrown on eight supports comes to lie", "[verification][impacts][friction]") {
  const double mu = GENERATE(0.0, 0.3);
  CAPTURE(mu);
  Mechanism m = build_mechanism(scene_from_text(cube(mu), "cube.json"), builtin_registry());
  const Channel balance = make_channel(system_of(m), "energy.balance"), lost = make_channel(system_of(m), "energy.dissipated");
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, {"dopri5", 0, 1e-8, 0});
  balance.memory->start(Sample(dynamics, simulation.state(), {}));
  const double before = make_channel(system_of(m), "energy.total").value(Sample(dynamics, simulation.state(), {}));
  const SimulationReport& report = simulation.run_until(3);
  CHECK(report.impacts > 10);
  CHECK(report.impacts < 1000);
  const State& s = simulation.state();
  const Sample now(dynamics, s, {});
  const Vec3 v = s.v.head<3>();
  CHECK(s.q[2] == Approx(0.1).epsilon(1e-9));
  CHECK(std::abs(v[2]) < 1e-9);
  CHECK(s.v.tail<3>().norm() < 1e-9);
  CHECK(std::abs(balance.value(now)) < 1e-7);
  CHECK(std::count(s.modes.begin(), s.modes.end(), true) >= 3);
  if (mu == 0) CHECK(v[0] == Approx(0.5).epsilon(1e-9));
  if (mu > 0) CHECK(lost.value(now) == Approx(before - 0.981).epsilon(1e-9));
}

// x = cos(w t) comes to a wall at its turning point: a hair beyond touches nothing; a hair before takes what speed
// there is left.
TEST_CASE("a gap that grazes", "[verification][impacts]") {
  for (const double hair : {1e-9, -1e-9}) {
    CAPTURE(hair);
    System system;
    Body& ball = system.add_particle("ball", 1.0, {1, 0, 0});
    Marker &P = system.add_marker("P", ball), &S = system.add_marker("S", system.ground(), {{-5, 0, 0}, {}});
    system.add<SpringDamper>("spring", P, S, {.stiffness = 4, .free_length = 5});
    Marker& wall = system.add_marker("wall", system.ground());
    system.add<SlideStop>("stop", P, wall, {.axis = 0, .limit = -1 - hair, .low = true}).set_unilateral({0.5, 1e-3});
    Recorder recorder(system, {"ball.x"});
    Dynamics dynamics(system, std::make_unique<SchurSolver>());
    StepLoop simulation = simulate(dynamics, {"dop853", 0, 1e-12, 0}, 0.1);
    simulation.add_observer(recorder);
    const SimulationReport& report = simulation.run_until(4);
    CHECK(report.impacts == (hair > 0 ? 0 : 1));
    const Table& t = recorder.table();
    const double hit = 0.5 * (kPi - std::acos(1 + std::min(hair, 0.0)));  // there it stands still
    for (std::size_t i = 0; i < t.n_rows(); ++i) {
      const double time = t["t"][i];
      const double x = hair > 0 || time < hit ? std::cos(2 * time) : -(1 + hair) * std::cos(2 * (time - hit));
      CHECK(std::abs(t["ball.x"][i] - x) < 1e-8);  // 1e-13 m shift a touch at 9e-5 m/s by 1e-9 s
    }
  }
}

// The floor moves as a sine: its impulses do work, which the law's line takes up.
TEST_CASE("a ball on a floor that moves keeps the books", "[verification][impacts]") {
  Ball ball(0.3, {0.7, 1e-3});
  ball.floor->move(std::make_shared<AlongZ>());
  Recorder recorder(ball.system, {"ball.z", "floor.gap", "energy.balance", "energy.drives", "energy.dissipated"});
  Dynamics dynamics(ball.system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, {"dop853", 0, 1e-11, 0}, 0.05);
  simulation.add_observer(recorder);
  CHECK(simulation.run_until(5).impacts > 10);
  const Table& t = recorder.table();
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    CHECK(std::abs(t["energy.balance"][i]) < 1e-9);
    CHECK(t["floor.gap"][i] > -1e-9);
    CHECK(t["floor.gap"][i] == Approx(t["ball.z"][i] - 0.02 * std::sin(20 * t["t"][i])).margin(1e-11));
  }
  CHECK(t["energy.dissipated"].back() > 0.1);
  CHECK(std::abs(t["energy.drives"].back()) > 0.01);
}

// What falls on a floor without restitution slides on it, its friction from the present reaction of the floor.
TEST_CASE("friction on a floor that holds one side only", "[verification][impacts][friction]") {
  const double h = 0.2, mu = 0.25, V = 2, fall = std::sqrt(2 * h / kG);
  Ball ball(h, {0, 1e-3});
  ball.body->start.v = {V, 0, 0};
  JointFriction::Options o;
  o.mu = mu, o.smoothing_speed = 1e-3, o.load_smoothing = 0;
  ball.system.add(std::make_unique<JointFriction>("rub", *ball.floor, o));
  Recorder recorder(ball.system, {"ball.vx", "energy.balance", "rub.normal_force"});
  Dynamics dynamics(ball.system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, {"dop853", 0, 1e-11, 0}, 0.02);
  simulation.add_observer(recorder);
  simulation.run_until(0.9);
  const Table& t = recorder.table();
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    const double on = std::max(0.0, t["t"][i] - fall);
    CHECK(t["ball.vx"][i] == Approx(V - mu * kG * on).epsilon(1e-9));
    CHECK(t["rub.normal_force"][i] == Approx(on > 0 ? 0.5 * kG : 0.0).margin(1e-9));
    CHECK(std::abs(t["energy.balance"][i]) < 1e-9);
  }
}

TEST_CASE("a run that is rewound counts the same impacts again", "[verification][impacts]") {
  Ball ball(1, {0.8, 1e-3});
  Dynamics dynamics(ball.system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, {"dop853", 0, 1e-10, 0});
  simulation.run_until(1.5);
  const State saved = simulation.state();
  simulation.run_until(3);
  const State end = simulation.state();
  const double lost = end.z[ball.floor->impact_memory()];
  CHECK(lost > saved.z[ball.floor->impact_memory()]);
  simulation.set_state(saved);
  simulation.run_until(3);
  CHECK(simulation.state().z[ball.floor->impact_memory()] == Approx(lost).epsilon(1e-12));
  CHECK((simulation.state().q - end.q).norm() < 1e-10);
  CHECK(simulation.state().modes == end.modes);
}

TEST_CASE("steps with one-sided joints allocate nothing, in flight and at rest", "[verification][impacts]") {
  if (!allocations_are_counted()) return;
  const bool resting = GENERATE(false, true);
  const std::string method = GENERATE("dop853", "rk4");
  Ball ball(resting ? 0.0 : 10.0, {});
  Dynamics dynamics(ball.system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, {method, 1e-3, 1e-9, 0});
  for (int i = 0; i < 5; ++i) simulation.step(1e-3);
  CAPTURE(resting, method);
  CHECK(allocations_of([&] {
          for (int i = 0; i < 20; ++i) simulation.step(1e-3);
        }) == 0);
  CHECK(simulation.state().modes[0] == resting);
}

TEST_CASE("events switch a one-sided joint off and on", "[verification][impacts]") {
  Ball ball(0.1, {0, 1e-3});
  ball.body->start.v = {0, 0, 3};
  Dynamics dynamics(ball.system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, {"dop853", 0, 1e-10, 0});
  simulation.add_event({.name = "off", .at = 0.05, .deactivate = {"floor"}});
  simulation.run_until(1);
  CHECK(simulation.report().impacts == 0);
  CHECK(simulation.state().q[2] < -1);
  simulation.add_event({.name = "on", .at = 1.1, .activate = {"floor"}});
  testing::check_words(testing::message_of<AssemblyError>([&] { simulation.run_until(2); }),
                       {"event 'on'", "on the wrong side of the one-sided joint 'floor'"});
}

TEST_CASE("one-sided joints that cannot be are named", "[verification][impacts]") {
  const auto refusal = [](const Unilateral& u) { return testing::message_of<ModelError>([&] { Ball(1, u); }); };
  testing::check_words(refusal({1.2, 1e-3}), {"'floor'", "restitution 1.2", "0 and 1"});
  testing::check_words(refusal({0.5, 0.0}), {"'floor'", "rest_speed", "never end"});
  System system;
  Body& a = system.add_body("a", MassProperties{1.0, Vec3::Zero(), Mat3::Identity()});
  system.add<Spherical>("ball", a, system.ground(), pose_at(Vec3::Zero())).set_unilateral({});
  testing::check_words(testing::message_of<ModelError>([&] { system.setup(); }),
                       {"'ball'", "3 constraints", "exactly one"});
  Ball below(-0.1, {});
  Dynamics dynamics(below.system, std::make_unique<SchurSolver>());
  StepLoop simulation = simulate(dynamics, {"dop853", 0, 1e-10, 0});
  testing::check_words(testing::message_of<AssemblyError>([&] { simulation.run_until(1); }),
                       {"0.1 m on the wrong side of the one-sided joint 'floor'", "\"side\": \"below\""});
}

}  // namespace impacts_test
