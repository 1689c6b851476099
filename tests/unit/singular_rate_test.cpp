// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/evaluate/singular_rate.h"

#include <cmath>

#include <lockstep/author/registry.h>
#include <lockstep/lockstep.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace singular_rate_test {

using namespace lockstep;

namespace {

/// Parallelograms in a row: uprights and bars of 1 m and 1 kg at the angle theta, turning at w; hinges in space.
struct Bays {
  int n;
  System system{System::Options{{0, -9.81, 0}}};

  /// `law`: of the turn of the first upright; null: none.
  Bays(int n_bays, double theta, double w, const LawPtr<MotionLaw>& law = nullptr) : n(n_bays) {
    const Vec3 d(std::cos(theta), std::sin(theta), 0), z = Vec3::UnitZ(), x = Vec3::UnitX();
    std::vector<Body*> uprights;
    for (int k = 0; k <= n; ++k) {
      const std::string number = std::to_string(k);
      Body& b = system.add_body("upright " + number, shapes::slender_rod(1, k * x, k * x + d, 0.01));
      b.start = {cross(Vec3(w * z), Vec3(0.5 * d)), w * z};
      Revolute& hinge = system.add<Revolute>("A" + number, b, system.ground(), pose_at(k * x, z));
      if (k == 0 && law) hinge.drive(Axis::rz, law);
      uprights.push_back(&b);
    }
    for (int k = 0; k < n; ++k) {
      const std::string number = std::to_string(k);
      Body& b = system.add_body("bar " + number, shapes::slender_rod(1, k * x + d, (k + 1) * x + d, 0.01));
      b.start = {cross(Vec3(w * z), d), Vec3::Zero()};
      system.add<Revolute>("B" + number, b, *uprights[k], pose_at(k * x + d, z));
      system.add<Revolute>("C" + number, b, *uprights[k + 1], pose_at((k + 1) * x + d, z));
    }
    system.setup();
  }
  /// A theta'' = -G cos theta, with all rods in one motion.
  double acceleration(double theta) const {
    return -9.81 * (0.5 * (n + 1) + n) * std::cos(theta) / ((n + 1) / 3.0 + n);
  }
  /// The angle after t from `theta` at w, by a small step of order 4 of its own.
  double angle(double theta, double w, double t) const {
    const int n_steps = 20000;
    const double h = t / n_steps;
    for (int i = 0; i < n_steps; ++i) {
      const double k1 = acceleration(theta), k2 = acceleration(theta + 0.5 * h * w);
      const double k3 = acceleration(theta + 0.5 * h * (w + 0.5 * h * k1)),
                   k4 = acceleration(theta + h * (w + 0.5 * h * k2));
      theta += h * (w + h / 6 * (k1 + k2 + k3));
      w += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return theta;
  }
};

Dynamics schur_dynamics(System& system) {
  return Dynamics(system, builtin_registry().solvers.make("schur", Params{}, nullptr, "run.solver"));
}

// Whether there are rates at the start, from both sides of it.
bool finds_rates(Bays& bays) {
  Dynamics dynamics = schur_dynamics(bays.system);
  State s = bays.system.start();
  SingularRate through;
  through.begin(s);
  StateRate k{VecX::Zero(s.q.size()), VecX::Zero(s.v.size()), VecX::Zero(0)};
  return through.find(dynamics, s, 0, k) == SingularRate::Sides::agree;
}

}  // namespace

TEST_CASE("rates in a singular configuration come from both sides of it", "[unit][dynamics]") {
  const int n = GENERATE(1, 2, 6);
  Bays bays(n, 0, 1.5);
  Dynamics dynamics = schur_dynamics(bays.system);
  const State s = bays.system.start();
  SingularRate through;
  through.begin(s);
  StateRate k{VecX::Zero(s.q.size()), VecX::Zero(s.v.size()), VecX::Zero(0)}, solved = k;
  State limit = s;
  REQUIRE(through.find(dynamics, limit, 0, k) == SingularRate::Sides::agree);
  // d^8 = 7e-13, and d^6 = 7e-10 without the last of four distances
  CHECK((limit.q - s.q).norm() < 1e-12);
  CHECK((limit.v - s.v).norm() < 1e-11);
  CHECK(through.error() < 7e-10);
  const double exact = bays.acceleration(0);
  CAPTURE(n, exact);
  for (int i = 0; i <= n; ++i) {
    const int slot = bays.system.body("upright " + std::to_string(i)).slot;
    CHECK(k.v[6 * slot + 5] == Approx(exact).epsilon(1e-9));
  }
  dynamics.rate(s, solved);
  CHECK((k.q - solved.q).norm() < 1e-10);
  if (n > 1) CHECK((k.v - solved.v).norm() > 0.1);  // what one solve makes of it
}

// Before its first point a spline refuses: there is no other side. Redundant rows are looked for beside the start of a run.
TEST_CASE("laws that begin with the run are not asked before it", "[unit][dynamics]") {
  const double w = 1.5;
  const LawPtr<MotionLaw> begins = laws::spline({{0, 0}, {0.4, 0.4 * w}, {1, w}});
  SECTION("no rates from both sides") {
    Bays bays(2, 0, w, begins);
    CHECK_FALSE(finds_rates(bays));
  }
  SECTION("the run is the one of its law") {
    Bays bays(2, 0.6, w, begins);
    Dynamics dynamics(bays.system, std::make_unique<SchurSolver>(),
                      {.formulation = Formulation::omega, .stabilization = {}});
    StepLoop run(dynamics,
                 builtin_registry().integrators.make("dop853", Params{{"stages", "auto"}}, nullptr, "run.integrator"),
                 {.tolerance = {1e-9, 1e-11}});
    run.run_until(0.5);
    const double theta = 0.6 + 0.5 * w;
    for (const int k : {0, 1}) {
      const Vec3 top = body_pose(bays.system.body("bar " + std::to_string(k)), run.state()).x - Vec3(k + 0.5, 0, 0);
      CHECK((top - Vec3(std::cos(theta), std::sin(theta), 0)).norm() < 1e-8);
    }
  }
}

TEST_CASE("at rest in a singular configuration no motion is preferred", "[unit][dynamics]") {
  Bays bays(2, 0, 0);
  CHECK_FALSE(finds_rates(bays));
}

TEST_CASE("a run starts in a singular configuration and follows the motion", "[unit][dynamics]") {
  const char* method = GENERATE("dop853", "dopri5");
  const char* stages = GENERATE("auto", "manifold");
  Bays bays(2, 0, 1.5);
  Dynamics dynamics = schur_dynamics(bays.system);
  StepLoop run(dynamics,
               builtin_registry().integrators.make(method, Params{{"stages", stages}}, nullptr, "run.integrator"),
               {.tolerance = {1e-9, 1e-11}});
  run.run_until(0.5);
  const Vec3 top = body_pose(bays.system.body("bar 0"), run.state()).x - Vec3(0.5, 0, 0);
  const double theta = bays.angle(0, 1.5, 0.5);
  CAPTURE(method, stages, theta);
  CHECK((top - Vec3(std::cos(theta), std::sin(theta), 0)).norm() < 2e-8);
}

TEST_CASE("a start at rest in a singular configuration is rejected", "[unit][dynamics]") {
  Bays bays(2, 0, 0);
  Dynamics dynamics = schur_dynamics(bays.system);
  StepLoop run(dynamics,
               builtin_registry().integrators.make("dop853", Params{{"stages", "auto"}}, nullptr, "run.integrator"));
  testing::check_words(testing::message_of<StepError>([&] { run.run_until(0.1); }),
                       {"dop853", "singular configuration", "several motions continue, or none",
                        "start slightly off it"});
}

}  // namespace singular_rate_test
