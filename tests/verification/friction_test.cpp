// SPDX-License-Identifier: BSD-3-Clause
// Friction from the present reaction against closed forms and scalar equations of motion, and its energy.
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/lockstep.h>
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/load_cell.h"
#include "tests/support/messages.h"
#include "tests/support/worst.h"

namespace friction_test {

using namespace lockstep;
using testing::LoadCell;

namespace {

constexpr double kG = 9.81;

/// A block of 2 kg on a level guide along x, its mass centre a height above the guide.
struct Block {
  System system{{{0, 0, -kG}}};
  Body* body;
  JointFriction* friction;

  Block(JointFriction::Options options, double speed, double height = 0) {
    body = &system.add_body("block",
                            MassProperties{2.0, {0, 0, height}, Vec3(0.02, 0.03, 0.04).asDiagonal().toDenseMatrix()});
    body->start.v = {speed, 0, 0};
    auto& guide = system.add<Prismatic>("guide", *body, system.ground(), pose_at(Vec3::Zero(), Vec3::UnitX()));
    friction =
        &static_cast<JointFriction&>(system.add(std::make_unique<JointFriction>("guide.friction", guide, options)));
  }
};

/// A wheel of 3 kg with its mass centre an offset from its axis z, 0.02 kg m^2 about that.
struct Wheel {
  System system;
  Body* body;

  Wheel(JointFriction::Options options, double rate, double offset, const Vec3& gravity) : system({gravity}) {
    body = &system.add_body("wheel",
                            MassProperties{3.0, {offset, 0, 0}, Vec3(0.015, 0.015, 0.02).asDiagonal().toDenseMatrix()});
    body->start.w = {0, 0, rate};
    auto& bearing = system.add<Revolute>("bearing", *body, system.ground(), pose_at(Vec3::Zero()));
    system.add(std::make_unique<JointFriction>("bearing.friction", bearing, options));
  }
};

struct Run {
  Table table;
  SimulationReport report;
};

Run run(System& system, const std::string& method, const Params& keys, double step, double tolerance, double end,
        const std::vector<std::string>& columns, double interval) {
  const Registry registry = builtin_registry();
  Recorder recorder(system, {columns.begin(), columns.end()});
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoopOptions options;
  options.step = step, options.tolerance = {tolerance, 1e-2 * tolerance}, options.output = interval;
  StepLoop simulation(dynamics, registry.integrators.make(method, keys, &registry, "method"), options);
  simulation.add_observer(recorder);
  simulation.run_until(end);
  return {recorder.table(), simulation.report()};
}

double worst(const Table& table, const std::string& column, const std::function<double(double)>& truth) {
  double most = 0;
  for (std::size_t i = 0; i < table.n_rows(); ++i) keep_worst(most, std::abs(table[column][i] - truth(table["t"][i])));
  return most;
}

double largest(const Table& table, const std::string& column) {
  return worst(table, column, [](double) { return 0.0; });
}

}  // namespace

// v' = -mu g tanh(v/v0):  sinh(v/v0) = sinh(V/v0) exp(-mu g t/v0), and dx = -v dv/(mu g tanh(v/v0)).
TEST_CASE("a block slides to rest under Coulomb friction as in the closed form", "[verification][friction]") {
  const double mu = 0.3, v0 = 0.05, V = 1.5;
  JointFriction::Options o;
  o.mu = mu, o.smoothing_speed = v0, o.load_smoothing = 0;
  Block block(o, V);
  const double end = 0.8;
  const Run r =
      run(block.system, "dop853", {}, 0, 1e-12, end,
          {"block.x", "block.vx", "energy.balance", "guide.friction.normal_force", "energy.dissipated"}, 0.02);
  const auto speed = [&](double t) { return v0 * std::asinh(std::sinh(V / v0) * std::exp(-mu * kG * t / v0)); };
  const auto way = [&](double t) {
    const auto rate = [&](double v) { return v / (mu * kG * std::tanh(v / v0)); };
    return boost::math::quadrature::gauss_kronrod<double, 61>::integrate(rate, speed(t), V, 15, 1e-13);
  };
  CHECK(worst(r.table, "block.vx", speed) < 1e-10);
  CHECK(worst(r.table, "block.x", way) < 1e-10);
  CHECK(worst(r.table, "guide.friction.normal_force", [](double) { return 2 * kG; }) < 1e-10);
  CHECK(largest(r.table, "energy.balance") < 1e-9);
  // the sharp law's way and time, which the smooth one approaches from above
  const double last = r.table["block.x"].back();
  CHECK(last > V * V / (2 * mu * kG));
  CHECK(last < V * V / (2 * mu * kG) + 2 * v0 * V / (mu * kG));
  CHECK(r.table["energy.dissipated"].back() == Approx(V * V).epsilon(1e-3));  // m V^2/2, nearly at rest
}

// The friction acts at the guide, a height h under the mass centre; its moment F h presses on the guide as well:
// F = mu (m g + F h/b), so v' = -mu g/(1 - mu h/b). The reaction is made by the friction that it makes.
TEST_CASE("friction and the reaction that it makes itself are found together", "[verification][friction]") {
  const double mu = 0.4, h = 0.3, b = 0.2, V = 3.0;
  JointFriction::Options o;
  o.mu = mu, o.smoothing_speed = 1e-3, o.load_smoothing = 0, o.bending_length = b;
  const double a = mu * kG / (1 - mu * h / b);
  const auto speed = [&](double t) { return V - a * t; };
  struct Way {
    std::string method;
    double step, tolerance, error;
  };
  const auto way = GENERATE(Way{"dop853", 0, 1e-11, 1e-9}, Way{"dopri5", 0, 1e-10, 1e-8}, Way{"rk4", 1e-3, 1e-6, 1e-10},
                            Way{"radau5", 0, 1e-10, 1e-8}, Way{"generalized_alpha", 1e-3, 1e-6, 1e-8});
  CAPTURE(way.method);
  Block block(o, V, h);
  const Run r = run(block.system, way.method, {}, way.step, way.tolerance, 0.2,
                    {"block.vx", "energy.balance", "guide.friction.friction_force"}, 0.01);
  CHECK(worst(r.table, "block.vx", speed) < way.error);
  CHECK(worst(r.table, "guide.friction.friction_force", [&](double) { return -2 * a; }) < 1e-6);
  CHECK(largest(r.table, "energy.balance") < (way.method == "generalized_alpha" ? 2e-6 : 1e-6));  // J, of 9 J
}

// Without gravity the bearing carries the mass centre only: N^2 = (m d)^2 (w^4 + w'^2), J w' = -mu r N, so
// w' = -c w^2 with c = k/sqrt(J^2 - k^2), k = mu r m d, and w = W/(1 + c W t).
TEST_CASE("an unbalanced wheel is braked by its centrifugal load", "[verification][friction]") {
  const double mu = 0.3, r = 0.05, d = 0.1, W = 30;
  JointFriction::Options o;
  o.mu = mu, o.radius = r, o.smoothing_speed = 1e-4, o.load_smoothing = 0;
  const double J = 0.02 + 3 * d * d, k = mu * r * 3 * d, c = k / std::sqrt(J * J - k * k);
  const auto formulation = GENERATE(Formulation::omega, Formulation::quaternion);
  Wheel wheel(o, W, d, Vec3::Zero());
  if (formulation == Formulation::omega) {
    const Run run1 =
        run(wheel.system, "dop853", {}, 0, 1e-12, 2.0, {"bearing.omega_z", "bearing.rz", "energy.balance"}, 0.1);
    CHECK(worst(run1.table, "bearing.omega_z", [&](double t) { return W / (1 + c * W * t); }) < 1e-9);
    CHECK(worst(run1.table, "bearing.rz", [&](double t) { return std::log(1 + c * W * t) / c; }) < 1e-9);
    CHECK(largest(run1.table, "energy.balance") < 1e-9);
  } else {
    Dynamics dynamics(wheel.system, std::make_unique<SparseSolver>(), {formulation, {}});
    const Evaluated& v = dynamics.evaluate(wheel.system.start());
    CHECK(v.a[5] == Approx(-c * W * W).epsilon(1e-11));
  }
}

// J w' = -mu r m g tanh(r w/v0): sinh(r w/v0) = sinh(r W/v0) exp(-mu r^2 m g t/(J v0)).
TEST_CASE("a level wheel runs down in its bearing as in the closed form", "[verification][friction]") {
  const double mu = 0.2, r = 0.04, v0 = 0.1, W = 50, J = 0.02;
  JointFriction::Options o;
  o.mu = mu, o.radius = r, o.smoothing_speed = v0, o.load_smoothing = 0;
  const bool radial = GENERATE(true, false);
  if (!radial) o.radius = 0, o.axial_radius = r;
  Wheel wheel(o, W, 0, radial ? Vec3(0, -kG, 0) : Vec3(0, 0, -kG));
  const Run run1 = run(wheel.system, "dop853", {}, 0, 1e-12, 6.0, {"bearing.omega_z", "energy.balance"}, 0.1);
  const auto rate = [&](double t) {
    return v0 / r * std::asinh(std::sinh(r * W / v0) * std::exp(-mu * r * r * 3 * kG * t / (J * v0)));
  };
  CHECK(worst(run1.table, "bearing.omega_z", rate) < 1e-9);
  CHECK(largest(run1.table, "energy.balance") < 1e-9);
}

TEST_CASE("Stribeck friction follows its scalar equation", "[verification][friction]") {
  JointFriction::Options o;
  o.mu = 0.2, o.mu_static = 0.35, o.stribeck_speed = 0.3, o.smoothing_speed = 0.02, o.viscous = 1.5;
  o.preload = 4, o.load_smoothing = 0;
  Block block(o, 2.0);
  const Run r = run(block.system, "dop853", {}, 0, 1e-12, 1.0, {"block.x", "block.vx", "energy.balance"}, 0.05);
  const double N = 2 * kG + o.preload;
  using Y = std::array<double, 2>;
  const auto rate = [&](const Y& y, Y& yd, double) {
    const double s = y[1] / o.stribeck_speed;
    const double mu = (o.mu + (o.mu_static - o.mu) * std::exp(-s * s)) * std::tanh(y[1] / o.smoothing_speed);
    yd = {y[1], -(mu * N + o.viscous * y[1]) / 2.0};
  };
  namespace ode = boost::numeric::odeint;
  Y y{0.0, 2.0};
  double t = 0;
  for (std::size_t i = 0; i < r.table.n_rows(); ++i) {
    const double to = r.table["t"][i];
    if (to > t)
      ode::integrate_adaptive(ode::make_controlled<ode::runge_kutta_fehlberg78<Y>>(1e-14, 1e-14), rate, y, t, to, 1e-4);
    t = to;
    CHECK(std::abs(r.table["block.x"][i] - y[0]) < 1e-10);
    CHECK(std::abs(r.table["block.vx"][i] - y[1]) < 1e-10);
  }
  CHECK(largest(r.table, "energy.balance") < 1e-9);
}

TEST_CASE("friction that jams is an error that names force and link", "[verification][friction]") {
  JointFriction::Options o;
  o.mu = 0.8, o.bending_length = 0.2;
  Block block(o, 1.0, 0.3);  // mu h/b = 1.2
  const std::string message = testing::message_of<SolveError>([&] {
    Dynamics dynamics(block.system, std::make_unique<SchurSolver>());
    dynamics.evaluate(block.system.start());
  });
  testing::check_words(message, {"guide.friction", "joint_friction", "joint 'guide'", "reduce the coefficient"});
}

namespace {

/// Pushes the block along its guide by what `law` says of the guide's normal force.
class Answer final : public Force, public Reacting {
 public:
  Answer(const Lock& link, std::function<double(double)> law)
      : Force("answer"), Reacting(static_cast<const Force&>(*this)), link_(&link), law_(std::move(law)) {}
  std::string_view type() const override { return "answer"; }
  std::vector<const Marker*> markers() const override { return {}; }
  void setup() override {}
  void apply(const Inputs&, WrenchSum&) const override {}
  const Reacting* reacting() const override { return this; }
  std::vector<const Lock*> reads() const override { return {link_}; }
  void react(const Inputs& in, const Reactions& reactions, WrenchSum& out) const override {
    const double normal = reactions.on_body_of(MarkerFrame(*link_->pairs().front().first), *link_, in).force[2];
    out.force(0, {0, 0, law_(normal)}, in.slot(0).x);
  }

 private:
  const Lock* link_;
  std::function<double(double)> law_;
};

std::string refusal_of(const std::function<double(double)>& law) {
  System system{{{0, 0, -kG}}};
  Body& body = system.add_body("block", MassProperties{2.0, Vec3::Zero(), Mat3::Identity()});
  auto& guide = system.add<Prismatic>("guide", body, system.ground(), pose_at(Vec3::Zero(), Vec3::UnitX()));
  system.add(std::make_unique<Answer>(guide, law));
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  return testing::message_of<SolveError>([&] { dynamics.evaluate(system.start()); });
}

}  // namespace

TEST_CASE("a force on its own reactions that does not converge is reported with its cause",
          "[verification][friction]") {
  // N = m g - F(N): it settles for slopes below one, and Anderson's line meets a straight one of any slope at once.
  testing::check_words(refusal_of([](double normal) { return normal > 10 ? 15.0 : -15.0; }),
                       {"force 'answer'", "joint 'guide'", "100 % still changes after 50 solutions",
                        "jumps as a function of them", "over a range of reactions"});
  double calls = 0;
  testing::check_words(
      refusal_of([&](double) { return ++calls; }),
      {"force 'answer'", "gives different forces at the same reactions", "depend on its inputs and on the reactions alone"});
  JointFriction::Options o;
  o.mu = 0.8, o.bending_length = 0.2;
  Block block(o, 1.0, 0.3);  // mu h/b = 1.2: each change comes back 1.2 times as large
  testing::check_words(testing::message_of<SolveError>([&] {
                         Dynamics dynamics(block.system, std::make_unique<SchurSolver>());
                         dynamics.evaluate(block.system.start());
                       }),
                       {"multiplies a change by 1.2", "jams its joint", "reduce the coefficient"});
}

// How two aligned hinges share their load is the choice of each solver; the rounding of it must not keep the friction from
// settling. A looser tolerance gives the same angle.
TEST_CASE("a door on two hinges with friction rotates with every solver", "[verification][friction]") {
  const auto turned = [](const std::string& solver, const std::string& integrator, double tolerance) {
    System system{{{0, 0, -kG}}};
    Body& door = system.add_body("door", shapes::box(25, {0.8, 0.05, 2.1}));
    door.home.x = {0.4, 0, 1.05};
    door.start.v = {0, 0.4, 0}, door.start.w = {0, 0, 1};
    JointFriction::Options options;
    options.mu = 0.1, options.radius = 0.02;
    for (const double z : {0.3, 1.8}) {
      const std::string name = z < 1 ? "low" : "high";
      const Lock& hinge = system.add<Revolute>(name, door, system.ground(), pose_at({0, 0, z}));
      system.add(std::make_unique<JointFriction>(name + ".friction", hinge, options));
    }
    Simulation run(system, {.integrator = integrator, .solver = solver, .tolerance = tolerance});
    run.record({"low.rz"});
    run.run_until(1);
    return run.table()["low.rz"].back();
  };
  const double angle = turned("dense", "dop853", 1e-8);
  CHECK(turned("schur", "dopri5", 1e-6) == Approx(angle).margin(1e-5));
  for (const char* solver : {"schur", "block", "sparse"}) {
    CAPTURE(solver);
    CHECK(turned(solver, "dop853", 1e-8) == Approx(angle).margin(1e-5));
  }
}

TEST_CASE("rattle rejects friction", "[verification][friction]") {
  JointFriction::Options o;
  o.mu = 0.3;
  Block block(o, 1.0);
  testing::check_words(
      testing::message_of<ModelError>([&] { run(block.system, "rattle2", {}, 1e-3, 1e-6, 0.1, {"block.x"}, 0.01); }),
      {"rattle2", "guide.friction", "reactions", "dopri5"});
}

TEST_CASE("steps with friction allocate nothing", "[verification][friction]") {
  if (!allocations_are_counted()) return;
  JointFriction::Options o;
  o.mu = 0.4, o.bending_length = 0.2;
  Block block(o, 3.0, 0.3);
  const std::string method = GENERATE("dop853", "rk4", "radau5", "generalized_alpha");
  const Registry registry = builtin_registry();
  Dynamics dynamics(block.system, std::make_unique<SchurSolver>());
  const auto integrator = registry.integrators.make(method, {}, &registry, "method");
  State s = block.system.start();
  integrator->begin(dynamics, s);
  for (int i = 0; i < 5; ++i) integrator->step(dynamics, s, 1e-3);
  CAPTURE(method);
  CHECK(allocations_of([&] {
          for (int i = 0; i < 10; ++i) integrator->step(dynamics, s, 1e-3);
        }) == 0);
}

TEST_CASE("in a plane friction is the same, and friction with components out of the plane is rejected",
          "[verification][friction]") {
  JointFriction::Options o;
  o.mu = 0.4, o.smoothing_speed = 1e-3, o.load_smoothing = 0, o.bending_length = 0.2;
  Block space(o, 3.0, 0.3), plane(o, 3.0, 0.3);
  plane.system.set_planar(Plane{1});
  Dynamics a(space.system, std::make_unique<SchurSolver>()), b(plane.system, std::make_unique<SchurSolver>());
  const double in_space = a.evaluate(space.system.start()).a[0], in_plane = b.evaluate(plane.system.start()).a[0];
  CHECK(std::abs(in_space) > 5);
  CHECK(in_plane == Approx(in_space).epsilon(1e-12));
  Block offset(o, 3.0, 0.3);
  offset.body->mass.center = {0, 0.1, 0.3};  // along the plane's normal
  offset.system.changed();
  offset.system.set_planar(Plane{1});
  testing::check_words(testing::message_of<ModelError>([&] { offset.system.setup(); }),
                       {"guide.friction", "planar", "moments"});
}

TEST_CASE("a fixed joint that a force reads is not merged into a body", "[verification][friction]") {
  System system({{0, 0, -kG}});
  Body& foot = system.add_body("foot", MassProperties{1.0, Vec3::Zero(), Mat3::Identity()});
  Body& load = system.add_body("load", MassProperties{3.0, Vec3::Zero(), Mat3::Identity()});
  system.add<Prismatic>("guide", foot, system.ground(), pose_at(Vec3::Zero(), Vec3::UnitX()));
  auto& bolt = system.add<Fixed>("bolt", load, foot, pose_at(Vec3::Zero()));
  const bool read = GENERATE(false, true);
  if (read) system.add(std::make_unique<LoadCell>("cell", bolt));
  system.set_merge(true);
  system.setup();
  CHECK(system.merged(bolt) == !read);
  if (!read) return;
  const Channel weight = make_channel(system, "cell.weight");
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  const State start = system.start();
  CHECK(weight.value(Sample(dynamics, start, {})) == Approx(3 * kG).epsilon(1e-12));
}

TEST_CASE("friction: joints and parameters that cannot be are named", "[verification][friction]") {
  JointFriction::Options o;
  o.mu = 0.3;
  System system;
  Body& a = system.add_body("a", MassProperties{1.0, Vec3::Zero(), Mat3::Identity()});
  auto& ball = system.add<Spherical>("ball", a, system.ground(), pose_at(Vec3::Zero()));
  auto& rod = system.add<Revolute>("rod", a, system.ground(), pose_at(Vec3::Zero()));
  testing::check_words(testing::message_of<ModelError>([&] { JointFriction("f", ball, o); }),
                       {"'f'", "ball", "spherical", "revolute"});
  testing::check_words(testing::message_of<ModelError>([&] { JointFriction("f", rod, o); }), {"'f'", "radius"});
  o.mu = -1;
  testing::check_words(testing::message_of<ModelError>([&] { JointFriction("f", rod, o); }), {"'f'", "mu is -1"});
}

}  // namespace friction_test
