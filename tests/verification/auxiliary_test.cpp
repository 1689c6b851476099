// SPDX-License-Identifier: BSD-3-Clause
// States of the user's own, integrated with the mechanism: an integral action holds a slider against its weight, and an
// impulse is that of a reaction.
#include <cmath>
#include <memory>

#include <lockstep/integrators.h>
#include <lockstep/lockstep.h>
#include "tests/support/catch.h"

namespace auxiliary_test {

using namespace lockstep;

namespace {

/// One number, d/dt = z of the slider.
class IntegralOfHeight final : public Auxiliary {
 public:
  explicit IntegralOfHeight(const Body& body) : Auxiliary("controller"), body_(body) {}
  int size() const override { return 1; }
  void start(std::span<double> s) const override { s[0] = 0.25; }
  void rates(const Evaluated& values, std::span<double> sd) const override { sd[0] = values.in.slot(body_.slot).x[2]; }

 private:
  const Body& body_;
};

/// One number, d/dt = force along z, N, of a link on its first body.
class ImpulseOfLink final : public Auxiliary {
 public:
  explicit ImpulseOfLink(const Lock& link) : Auxiliary("impulse"), link_(link) {}
  int size() const override { return 1; }
  void rates(const Evaluated& values, std::span<double> sd) const override {
    const MarkerFrame P(*link_.pairs().front().first);
    sd[0] = Reactions(values).on_body_of(P, link_, values.in).force[2];
  }

 private:
  const Lock& link_;
};

}  // namespace

TEST_CASE("a user's own state is integrated with the mechanism and closes a loop", "[verification][system]") {
  // m z'' = -m g - k z - c z' - i s,  s' = z: a linear system of order 3, compared with its own matrix exponential.
  const double m = 2, g = 9.81, k = 50, c = 6, i = 40;
  System sys({.gravity = {0, 0, -g}});
  Body& slider = sys.add_body("slider", shapes::box(m, {0.1, 0.1, 0.1}));
  Marker& P = sys.add_marker("P", slider);
  sys.add<Prismatic>("guide", P, sys.add_marker("S", sys.ground()));
  Auxiliary& controller = sys.add(std::make_unique<IntegralOfHeight>(slider));
  sys.add(function_force("control", {&P}, [&](const Inputs& in, WrenchSum& out) {
    const Motion& O = in.slot(slider.slot);
    const double s = in.s[controller.first()];
    out.force(slider.slot, {0, 0, -k * O.x[2] - c * O.v[2] - i * s}, O.x);
  }));
  struct Method {
    std::unique_ptr<Integrator> integrator;
    double step, relative, error;  // a fixed step has no tolerance
  };
  const int which = GENERATE(0, 1, 2);
  Method method = which == 0   ? Method{std::make_unique<Dop853>(), 0, 1e-11, 1e-10}
                  : which == 1 ? Method{std::make_unique<Radau5>(), 0, 1e-11, 1e-9}
                               : Method{std::make_unique<GeneralizedAlpha>(), 1e-4, 0.1, 1e-6};
  CAPTURE(method.integrator->info().name);
  Dynamics dynamics(sys, std::make_unique<SchurSolver>());
  StepLoopOptions options;
  options.step = method.step;
  options.tolerance = {method.relative, 1e-2 * method.relative};
  StepLoop run(dynamics, std::move(method.integrator), options);
  run.run_until(3.0);

  // y = (z, z', s): y' = A y + b. Taylor's series of the exact flow over 3000 small steps: an oracle of another kind.
  Mat3 A;
  A << 0, 1, 0, -k / m, -c / m, -i / m, 1, 0, 0;
  const Vec3 b(0, -g, 0);
  Vec3 y(0, 0, 0.25);
  const double h = 1e-3;
  for (int n = 0; n < 3000; ++n) {
    Vec3 term = A * y + b, sum = h * term;
    double factor = h;
    for (int p = 2; p <= 8; ++p) {
      term = A * term;
      factor *= h / p;
      sum += factor * term;
    }
    y += sum;
  }
  State end = run.state();
  dynamics.to_slots(end);  // by itself dop853 runs in joint coordinates
  CHECK(std::abs(end.q[2] - y[0]) < method.error);
  CHECK(std::abs(end.v[2] - y[1]) < method.error);
  CHECK(std::abs(run.state().s[0] - y[2]) < method.error);
}

// Either hinge could carry all of the weight. Half a turn about the rod's axis swaps them and turns the weight over:
// the smallest reactions are halves.
TEST_CASE("a custom state reads the smallest reactions of redundant constraints, in joint coordinates too",
          "[verification][system][joint]") {
  const Formulation formulation = GENERATE(Formulation::joint, Formulation::omega);
  CAPTURE(to_string(formulation));
  const double m = 2, g = 9.81;
  System sys({.gravity = {0, 0, -g}});
  Body& door = sys.add_body("door", shapes::rod(m, {0, 0, 0}, {1, 0, 0}));
  door.start = {{0, 1.5, 0}, {0, 0, 3}};  // its centre is 0.5 m from the hinges
  const Lock& low = sys.add<Revolute>("low", door, sys.ground(), pose_at({0, 0, -0.5}));
  sys.add<Revolute>("high", door, sys.ground(), pose_at({0, 0, 0.5}));
  sys.add(std::make_unique<ImpulseOfLink>(low));
  Dynamics dynamics(sys, std::make_unique<SchurSolver>(), {.formulation = formulation, .stabilization = {}});
  State state = sys.start();
  dynamics.to_formulation(state);
  REQUIRE((state.coordinates != nullptr) == (formulation == Formulation::joint));
  StateRate rate;
  dynamics.rates(state, rate);
  CHECK(rate.s[0] == Approx(0.5 * m * g));
}

}  // namespace auxiliary_test
