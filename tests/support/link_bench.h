// SPDX-License-Identifier: BSD-3-Clause
// One link between bodies that a test puts where it likes: C, quantities and memory, step by step.
#pragma once

#include <memory>
#include <utility>

#include <lockstep/dynamics.h>
#include <lockstep/solvers.h>
#include <lockstep/joints.h>

namespace lockstep::testing {

/// A carrier "S" at the origin, body "P" with its marker at its origin; both move freely.
struct LinkBench {
  System system;
  Body& S;
  Body& P;
  std::unique_ptr<Dynamics> dynamics;
  const Evaluation* here = nullptr;  // after put()
  State state;

  explicit LinkBench(const Pose& start = {})
      : S(system.add_body("S", MassProperties{1.0, Vec3::Zero(), Mat3::Identity()})),
        P(system.add_body("P", MassProperties{1.0, Vec3::Zero(), Mat3::Identity()}, start)) {}
  Marker& p() { return system.add_marker("p", P); }
  Marker& s() { return system.add_marker("s", S); }

  /// Sets up; the state is the start.
  void begin() {
    system.setup();
    dynamics = std::make_unique<Dynamics>(system, std::make_unique<DenseSolver>());
    state = system.start();
  }
  /// Puts P there after dt, at the speed v (world) and w (its axes).
  void put(const Pose& at, double dt = 0, const Vec3& v = Vec3::Zero(), const Vec3& w = Vec3::Zero()) {
    state.t += dt;
    state.set_slot_pose(P.slot, at);
    state.set_slot_twist(P.slot, {v, w});
    here = &dynamics->gather(state);
  }
  void accept() { dynamics->accept(state); }
  double C(int k = 0) const { return here->rows().block(here->rows().entries.front()).C(k); }
  double quantity(const Lock& link, int k) const { return link.observable()->quantity(k, here->inputs()); }
};

/// The least value of f on [a, b]: looked for on a grid, then by golden section.
template <class F>
std::pair<double, double> least(F&& f, double a, double b, int n = 2000) {
  double at = a, value = f(a);
  for (int i = 1; i <= n; ++i)
    if (const double x = a + (b - a) * i / n, fx = f(x); fx < value) at = x, value = fx;
  double low = at - (b - a) / n, high = at + (b - a) / n;
  constexpr double kGolden = 0.6180339887498949;
  for (int i = 0; i < 60; ++i) {
    const double x = high - kGolden * (high - low), y = low + kGolden * (high - low);
    f(x) < f(y) ? high = y : low = x;
  }
  return {0.5 * (low + high), f(0.5 * (low + high))};
}

}  // namespace lockstep::testing
