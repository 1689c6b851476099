// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// @file What every integrator must hold: the same questions to all of them, with the numbers of each.

#include <cmath>
#include <functional>

#include <lockstep/error.h>
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/motions.h"

namespace lockstep::test {

/// Steps and margin at which a measured order shows.
struct OrderProbe {
  double T = 1;  ///< s
  int n = 50;    ///< steps, and twice as many
  double margin = 0.15;
};

/// An integrator and what is expected of it. Empty `adaptive`: fixed steps only; `dense_order` 0: no dense output.
struct IntegratorCase {
  const char* name = "";
  std::function<std::unique_ptr<Integrator>()> fixed{}, adaptive{};
  double order = 1;
  OrderProbe top{}, pendulum{};
  double dense_order = 0, dense_h = 0, dense_margin = 0;
  double dense_end = 1e-14;  ///< how well dense output meets the end of a step
  double eager_step = 3;     ///< s: a step that is rejected, `eager_rejections` times at least
  int eager_rejections = 2;
  double next_step = 0.01;     ///< s, made after it
  double error_at_most = 20;   ///< tolerances, of a run
  double violation_v = 1e-10;  ///< m/s: how well velocities meet the constraints
  double memory_margin = 0;    ///< of a step repeated after restore(); 0: equal to the last bit
};

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

/// A stone at this height, rising at 1 m/s, under that pull.
struct PulledStone {
  System system;
  PulledStone(double z, double v, std::function<double(double, double)> pull) {
    system.add_particle("stone", 1, {0, 0, z});
    system.body("stone").start.v = {0, 0, v};
    system.add(std::make_unique<Pull>(std::move(pull)));
  }
};

inline void check_order(const IntegratorCase& c) {
  const auto method = c.fixed();
  ThrownTop top;
  CHECK(measured_order(top, *method, c.top.T, c.top.n) == Approx(c.order).margin(c.top.margin));
  RodPendulum pendulum;
  CHECK(measured_order(pendulum, *method, c.pendulum.T, c.pendulum.n) == Approx(c.order).margin(c.pendulum.margin));
}

inline void check_constraints(const IntegratorCase& c) {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  const State s = stepped(dynamics, *c.fixed(), 1.0, 40);
  CHECK(dynamics.violation(s) < 1e-10);
  CHECK(dynamics.violation_v(s) < c.violation_v);
  CHECK(s.q.segment<4>(3).norm() == Approx(1).epsilon(1e-15));
}

inline void check_dense_order(const IntegratorCase& c) {
  const auto method = c.fixed();
  ThrownTop top;
  if (c.dense_h > 0)
    CHECK(measured_dense_order(top, *method, c.dense_h) == Approx(c.dense_order).margin(c.dense_margin));
}

/// A method without dense output returns false, always.
inline void check_dense_ends(const IntegratorCase& c) {
  ThrownTop top;
  Dynamics dynamics = dynamics_of(top.system);
  const auto method = c.fixed();
  const bool dense = c.dense_order > 0;
  State s = top.system.start(), inside = s;
  const State begin = s;
  CHECK_FALSE(method->dense(0, inside));
  method->begin(dynamics, s);
  CHECK(method->dense(0, inside) == dense);
  method->step(dynamics, s, 0.1);
  REQUIRE(method->dense(0, inside) == dense);
  if (!dense) return;
  CHECK((inside.q - begin.q).norm() < 1e-15);
  REQUIRE(method->dense(s.t, inside));
  CHECK((inside.q - s.q).norm() < c.dense_end);
  CHECK((inside.v - s.v).norm() < c.dense_end);
}

inline void check_tolerance(const IntegratorCase& c) {
  ThrownTop top;
  Dynamics dynamics = dynamics_of(top.system);
  double last = 1;
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    const auto method = c.adaptive();
    method->set_tolerance({tolerance, 1e-2 * tolerance});
    State s = top.system.start();
    method->begin(dynamics, s);
    double h = method->first_step(dynamics, s, 1.0);
    REQUIRE(h > 0);
    while (s.t < 2) h = method->step(dynamics, s, std::min(h, 2 - s.t)).h_next;
    CHECK(top.error(s) < c.error_at_most * tolerance);
    CHECK(top.error(s) < 0.1 * last);
    last = top.error(s);
  }
}

inline void check_rejected_steps(const IntegratorCase& c) {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  const auto eager = c.adaptive(), calm = c.adaptive();
  State a = pendulum.system.start(), b = a;
  eager->begin(dynamics, a);
  const StepReport tried = eager->step(dynamics, a, c.eager_step);
  REQUIRE(tried.rejected >= c.eager_rejections);
  calm->begin(dynamics, b);
  const StepReport made = calm->step(dynamics, b, tried.h);
  REQUIRE(made.rejected == 0);
  CHECK(a.t == b.t);
  CHECK(a.q == b.q);
  CHECK(a.v == b.v);
  CHECK(a.modes == b.modes);
  State x = a, y = b;
  const StepReport next_a = eager->step(dynamics, a, c.next_step), next_b = calm->step(dynamics, b, c.next_step);
  CHECK(next_a.h_next == next_b.h_next);  // the controllers remember the same
  CHECK(a.q == b.q);
  CHECK(eager->dense(x.t + 0.4 * c.next_step, x));
  CHECK(calm->dense(y.t + 0.4 * c.next_step, y));
  CHECK(x.q == y.q);
}

inline void check_memory(Integrator& method, double h, double margin = 0) {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  State s = pendulum.system.start();
  method.begin(dynamics, s);
  for (int i = 0; i < 3; ++i) method.step(dynamics, s, h);
  Snapshot memory;
  method.save(memory);
  State again = s;
  const StepReport first = method.step(dynamics, s, h);
  SnapshotReader in(memory);
  method.restore(in);
  const StepReport second = method.step(dynamics, again, h);
  CHECK(first.h_next == second.h_next);
  CHECK((s.q - again.q).norm() <= margin);
  CHECK((s.v - again.v).norm() <= margin);
}

/// Not a number beyond z = 1: chosen steps stay below, fixed ones throw and leave the state.
inline void check_failing_stage(const IntegratorCase& c) {
  PulledStone stone(0.9, 1, [](double, double z) { return -std::sqrt(1 - z); });
  Dynamics dynamics = dynamics_of(stone.system);
  const State before = stone.system.start();
  if (c.adaptive) {
    const auto method = c.adaptive();
    State s = before;
    method->begin(dynamics, s);
    const StepReport report = method->step(dynamics, s, 0.3);
    CHECK(report.rejected >= 2);
    CHECK(s.t == report.h);
    CHECK(s.q[2] < 1);
  }
  const auto fixed = c.fixed();
  State t = before;
  fixed->begin(dynamics, t);
  CHECK_THROWS_AS(
      [&] {
        for (int i = 0; i < 2; ++i) fixed->step(dynamics, t, 0.3);  // Euler sees the place one step later
      }(),
      NonFiniteError);
  if (t.t > 0) return;
  CHECK(t.q == before.q);
  CHECK(t.t == 0);
}

inline void check_vanishing_step(const IntegratorCase& c) {
  PulledStone stone(0, 0, [](double t, double) { return t < 0.5 ? 0.0 : 1e30 * std::sin(1e9 * t); });
  Dynamics dynamics = dynamics_of(stone.system);
  const auto method = c.adaptive();
  State s = stone.system.start();
  method->begin(dynamics, s);
  try {
    double h = 0.1;
    for (int i = 0; i < 1000; ++i) h = method->step(dynamics, s, h).h_next;
    FAIL("no error came");
  } catch (const StepError& e) {
    CHECK(e.t == Approx(0.5).epsilon(1e-6));
    CHECK(std::string(e.what()).find("--integrator") != std::string::npos);
    CHECK(s.t == e.t);
  }
}

/// Steps of h and the dense output inside them allocate nothing.
template <class Motion>
void check_allocations(Integrator& method, double h) {
  if (!allocations_are_counted()) return;
  Motion motion;
  Dynamics dynamics = dynamics_of(motion.system);
  State s = motion.system.start(), inside = s;
  method.begin(dynamics, s);
  const auto run = [&] {
    for (int i = 0; i < 20; ++i) {
      const double t = s.t;
      method.step(dynamics, s, h);
      method.dense(0.5 * (t + s.t), inside);
    }
  };
  run();
  CHECK(allocations_of(run) == 0);
}

}  // namespace lockstep::test
