// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>
#include "tests/support/integrator_checks.h"

namespace integrators_test {

using namespace lockstep;
using namespace lockstep::test;

namespace {

template <class Method, class... Args>
auto maker(Args... args) {
  return [=]() -> std::unique_ptr<Integrator> { return std::make_unique<Method>(args...); };
}

IntegratorCase alpha(const char* name, double rho) {
  return {.name = name,
          .fixed = maker<GeneralizedAlpha>(rho),
          .order = 2,
          .top = {1, 200, 0.15},
          .pendulum = {1, 100, 0.15},
          .dense_order = 2,  // as its steps: not measured inside one
          .dense_end = 1e-13,
          .next_step = 1e-3,
          .error_at_most = 100,
          .violation_v = 1e-8};
}

IntegratorCase adaptive_alpha() {
  IntegratorCase c = alpha("generalized_alpha", 0.8);
  c.adaptive = maker<GeneralizedAlpha>(0.8, true);
  return c;
}

IntegratorCase rattle(const char* name, int order) {
  return {.name = name,
          .fixed = maker<Rattle>(order),
          .order = double(order),
          .top = {1, 50, 0.05},
          .pendulum = {1, 50, 0.05}};
}

const std::vector<IntegratorCase>& all() {
  static const std::vector<IntegratorCase> cases = {
      {.name = "semi_implicit_euler",
       .fixed = maker<SemiImplicitEuler>(),
       .order = 1,
       .top = {1, 2000, 0.05},
       .pendulum = {1, 2000, 0.05}},
      {.name = "rk4", .fixed = maker<Rk4>(), .order = 4, .top = {1, 50, 0.15}, .pendulum = {1, 50, 0.15}},
      {.name = "dopri5",
       .fixed = maker<Dopri5>(true),
       .adaptive = maker<Dopri5>(),
       .order = 5,
       .top = {1, 25, 0.2},
       .pendulum = {1, 60, 0.2},  // from above: 5.4 at 10 steps
       .dense_order = 5,
       .dense_h = 0.05,
       .dense_margin = 0.2},
      {.name = "dop853",
       .fixed = maker<Dop853>(true),
       .adaptive = maker<Dop853>(),
       .order = 8,
       .top = {2, 14, 0.4},
       .pendulum = {2, 14, 0.5},
       .dense_order = 8,
       .dense_h = 0.2,
       .dense_margin = 0.5,
       .eager_step = 5,
       .eager_rejections = 1},
      {.name = "radau5",
       .fixed = maker<Radau5>(true),
       .adaptive = maker<Radau5>(),
       .order = 5,
       .top = {1, 20, 0.15},
       .pendulum = {1, 20, 0.15},
       .dense_order = 6,
       .dense_h = 0.1,
       .dense_margin = 0.2},
      rattle("rattle2", 2),
      rattle("rattle4", 4),
      adaptive_alpha(),
      alpha("generalized_alpha, rho_infinity 0", 0.0),
      alpha("generalized_alpha, rho_infinity 0.5", 0.5),
      alpha("generalized_alpha, rho_infinity 1", 1.0)};
  return cases;
}

template <class Check>
void each(Check&& check) {
  for (const IntegratorCase& c : all()) DYNAMIC_SECTION(c.name) {
      check(c);
    }
}

template <class Check>
void each_adaptive(Check&& check) {
  for (const IntegratorCase& c : all())
    if (c.adaptive) DYNAMIC_SECTION(c.name) {
        check(c);
      }
}

}  // namespace

TEST_CASE("every integrator converges with its order", "[unit][integrators]") { each(check_order); }

TEST_CASE("every integrator ends on the constraints, with unit quaternions", "[unit][integrators]") {
  each(check_constraints);
}

TEST_CASE("dense output has its local order", "[unit][integrators]") { each(check_dense_order); }

TEST_CASE("dense output meets both ends of the step", "[unit][integrators]") { each(check_dense_ends); }

TEST_CASE("the error of every adaptive integrator follows the tolerance", "[unit][integrators]") {
  each_adaptive([](const IntegratorCase& c) { check_tolerance(c); });
}

TEST_CASE("rejected steps leave no trace", "[unit][integrators]") { each_adaptive(check_rejected_steps); }

TEST_CASE("save and restore give every integrator its memory back", "[unit][integrators]") {
  each([](const IntegratorCase& c) { check_memory(*c.fixed(), 0.01, c.memory_margin); });
  each_adaptive([](const IntegratorCase& c) { check_memory(*c.adaptive(), 0.05); });
}

TEST_CASE("a stage that cannot be evaluated shortens the step, or is thrown", "[unit][integrators]") {
  each(check_failing_stage);
}

TEST_CASE("a step that shrinks to nothing is an error that names the time", "[unit][integrators]") {
  each_adaptive(check_vanishing_step);
}

TEST_CASE("a step of no integrator allocates, nor does its dense output", "[unit][integrators]") {
  each([](const IntegratorCase& c) { check_allocations<RodPendulum>(*c.fixed(), 0.0123456789); });
  each_adaptive([](const IntegratorCase& c) { check_allocations<RodPendulum>(*c.adaptive(), 0.0123456789); });
}

TEST_CASE("the library's allocations are counted", "[unit][integrators]") {
  if (!allocations_are_counted()) return;
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  CHECK(allocations_of([&] { Rk4().begin(dynamics, pendulum.system.start()); }) > 0);
}

TEST_CASE("a step of an implicit integrator with dampers allocates nothing", "[unit][integrators]") {
  each_adaptive([](const IntegratorCase& c) {
    if (!c.fixed()->info().implicit) return;
    check_allocations<SprungLoop>(*c.adaptive(), 0.00123456789);
    check_allocations<SprungLoop>(*c.fixed(), 1e-4);  // radau5 does not converge at ten times that, unless it may shrink
    if (c.name == std::string("generalized_alpha")) check_allocations<SprungLoop>(*c.fixed(), 0.00123456789);
  });
}

}  // namespace integrators_test
