#include "integrators/radau5.h"

#include <cmath>

#include "framework/foundation/support/error.h"
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/motions.h"

using namespace lockstep;

namespace {

/// A force along z on the first slot, given as a function of time and height.
class Pull final : public Force {
 public:
  explicit Pull(std::function<double(double, double)> f) : Force("pull"), f_(std::move(f)) {}
  std::string_view type() const override { return "pull"; }
  std::vector<const Marker*> markers() const override { return {}; }
  void setup() override {}
  void apply(const Inputs& in, WrenchSum& out) const override {
    out.force(0, Vec3(0, 0, f_(in.t, in.slot(0).x[2])), in.slot(0).x);
  }

 private:
  std::function<double(double, double)> f_;
};

}  // namespace

TEST_CASE("radau5 with a fixed step converges with order 5", "[unit][integrators]") {
  Radau5 method(true);
  ThrownTop top;
  CHECK(measured_order(top, method, 1.0, 20) == Approx(5).margin(0.15));
  RodPendulum pendulum;
  CHECK(measured_order(pendulum, method, 1.0, 20) == Approx(5).margin(0.15));
}

TEST_CASE("dense output of radau5 has local order 6", "[unit][integrators]") {
  Radau5 method(true);
  ThrownTop top;
  CHECK(measured_dense_order(top, method, 0.1) == Approx(6).margin(0.2));
}

TEST_CASE("dense output of radau5 meets both ends of the step", "[unit][integrators]") {
  ThrownTop top;
  Dynamics dynamics = dynamics_of(top.system);
  Radau5 method(true);
  State s = top.system.start(), inside = s;
  const State begin = s;
  CHECK_FALSE(method.dense(0, inside));
  method.begin(dynamics, s);
  CHECK(method.dense(0, inside));
  method.step(dynamics, s, 0.1);
  REQUIRE(method.dense(0, inside));
  CHECK((inside.q - begin.q).norm() < 1e-15);
  REQUIRE(method.dense(s.t, inside));
  CHECK((inside.q - s.q).norm() < 1e-14);
  CHECK((inside.v - s.v).norm() < 1e-14);
}

TEST_CASE("the error of radau5 follows the tolerance", "[unit][integrators]") {
  ThrownTop top;
  Dynamics dynamics = dynamics_of(top.system);
  double last = 1;
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    Radau5 method;
    method.set_tolerance({tolerance, 1e-2 * tolerance});
    State s = top.system.start();
    method.begin(dynamics, s);
    double h = method.first_step(dynamics, s, 1.0);
    REQUIRE(h > 0);
    while (s.t < 2) h = method.step(dynamics, s, std::min(h, 2 - s.t)).h_next;
    CHECK(top.error(s) < 20 * tolerance);
    CHECK(top.error(s) < 0.1 * last);
    last = top.error(s);
  }
}

TEST_CASE("rejected steps of radau5 leave no trace", "[unit][integrators]") {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  Radau5 eager, calm;
  State a = pendulum.system.start(), b = a;
  eager.begin(dynamics, a);
  const StepReport tried = eager.step(dynamics, a, 3.0);
  REQUIRE(tried.rejected > 1);
  calm.begin(dynamics, b);
  const StepReport made = calm.step(dynamics, b, tried.h);
  REQUIRE(made.rejected == 0);
  CHECK(a.t == b.t);
  CHECK(a.q == b.q);
  CHECK(a.v == b.v);
  CHECK(a.modes == b.modes);
  State c = a, d = b;
  const StepReport next_a = eager.step(dynamics, a, 0.01), next_b = calm.step(dynamics, b, 0.01);
  CHECK(next_a.h_next == next_b.h_next);  // the controllers remember the same
  CHECK(a.q == b.q);
  CHECK(eager.dense(c.t + 0.004, c));
  CHECK(calm.dense(d.t + 0.004, d));
  CHECK(c.q == d.q);
}

TEST_CASE("save and restore give radau5 its memory back", "[unit][integrators]") {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  Radau5 method;
  State s = pendulum.system.start();
  method.begin(dynamics, s);
  for (int i = 0; i < 3; ++i) method.step(dynamics, s, 0.05);
  Snapshot memory;
  method.save(memory);
  State again = s;
  const StepReport first = method.step(dynamics, s, 0.05);
  memory.rewind();
  method.restore(memory);
  const StepReport second = method.step(dynamics, again, 0.05);
  CHECK(first.h_next == second.h_next);
  CHECK(s.q == again.q);
}

TEST_CASE("a stage that cannot be evaluated shortens the step of radau5", "[unit][integrators]") {
  System system;
  system.add_particle("stone", 1, {0, 0, 0.9});
  system.body("stone").start.v = {0, 0, 1};
  system.add(std::make_unique<Pull>([](double, double z) { return -std::sqrt(1 - z); }));  // not a number beyond z = 1
  Dynamics dynamics = dynamics_of(system);
  Radau5 method;
  State s = system.start();
  const State before = s;
  method.begin(dynamics, s);
  const StepReport report = method.step(dynamics, s, 0.3);
  CHECK(report.rejected >= 2);
  CHECK(s.t == report.h);
  CHECK(s.q[2] < 1);
  Radau5 fixed(true);
  State t = before;
  fixed.begin(dynamics, t);
  CHECK_THROWS_AS(fixed.step(dynamics, t, 0.3), NonFiniteError);
  CHECK(t.q == before.q);
  CHECK(t.t == 0);
}

TEST_CASE("a step of radau5 that shrinks to nothing is an error that names the time", "[unit][integrators]") {
  System system;
  system.add_particle("stone", 1, {0, 0, 0});
  system.add(std::make_unique<Pull>([](double t, double) { return t < 0.5 ? 0.0 : 1e30 * std::sin(1e9 * t); }));
  Dynamics dynamics = dynamics_of(system);
  Radau5 method;
  State s = system.start();
  method.begin(dynamics, s);
  try {
    double h = 0.1;
    for (int i = 0; i < 1000; ++i) h = method.step(dynamics, s, h).h_next;
    FAIL("no error came");
  } catch (const StepError& e) {
    CHECK(e.t == Approx(0.5).epsilon(1e-6));
    CHECK(std::string(e.what()).find("--integrator") != std::string::npos);
    CHECK(s.t == e.t);
  }
}

TEST_CASE("a step of radau5 allocates nothing, nor does its dense output", "[unit][integrators]") {
  if (!allocations_are_counted()) return;
  SprungLoop loop;
  Dynamics dynamics = dynamics_of(loop.system);
  Radau5 method;
  State s = loop.system.start(), inside = s;
  method.begin(dynamics, s);
  const auto run = [&] {
    for (int i = 0; i < 10; ++i) {
      const double t = s.t;
      method.step(dynamics, s, 0.00123456789);
      method.dense(0.5 * (t + s.t), inside);
    }
  };
  run();
  CHECK(allocations_of(run) == 0);
}
