// SPDX-License-Identifier: BSD-3-Clause
// Mechanisms whose modes are known, and how eigenvalues are compared.
#pragma once

#include <algorithm>
#include <complex>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/modes.h>
#include <lockstep/solvers.h>
#include "tests/support/catch.h"

namespace lockstep::modes_bench {

using Complex = std::complex<double>;

inline Dynamics dynamics_of(System& sys) {
  return {sys, std::make_unique<DenseSolver>(), {.formulation = Formulation::omega, .stabilization = {}}};
}

inline Modes modes_of(System& sys, const ModesOptions& options = {}) {
  Dynamics dynamics = dynamics_of(sys);
  return find_modes(dynamics, sys.start(), options);
}

/// Each value of one list has one of its own in the other, within `tolerance` relative.
inline void check_same(std::vector<Complex> found, const std::vector<Complex>& truth, double tolerance) {
  REQUIRE(found.size() == truth.size());
  for (const Complex l : truth) {
    const auto nearest = std::ranges::min_element(found, {}, [&](const Complex& a) { return std::abs(a - l); });
    CAPTURE(l, *nearest);
    CHECK(std::abs(*nearest - l) <= tolerance * std::abs(l));
    found.erase(nearest);
  }
}

/// Two rods that hang from a hinge and a ball joint, a spring and a damper between the lower one and the ground, in a
/// world turned by q and moved by x; its links in either order.
inline void build_hanging(System& sys, const Pose& world, bool reversed) {
  const auto place = [&](const Vec3& x) { return Vec3(world.x + rotation(world.q) * x); };
  sys.set_gravity(rotation(world.q) * Vec3(0, -9.81, 0));
  const MassProperties rod{1.5, Vec3::Zero(), Vec3(0.12, 0.01, 0.13).asDiagonal()};
  Body& one = sys.add_body("one", rod, {place({0, -0.5, 0}), world.q});
  Body& two = sys.add_body("two", rod, {place({0, -1.5, 0}), world.q});
  const auto hinge = [&] { sys.add<Revolute>("A", one, sys.ground(), Pose{place(Vec3::Zero()), world.q}); };
  const auto ball = [&] { sys.add<Spherical>("B", two, one, Pose{place({0, -1, 0}), world.q}); };
  if (reversed)
    ball(), hinge();
  else
    hinge(), ball();
  Marker& P = sys.add_marker_at("P", two, {place({0, -2, 0}), {}});
  Marker& S = sys.add_marker_at("S", sys.ground(), {place({0, -3, 0}), {}});
  sys.add<SpringDamper>("spring", P, S, {.stiffness = 30, .damping = 2, .free_length = 0.8});
}

/// n rods of length 1 on hinges, hanging.
inline void build_chain(System& sys, int n) {
  Body* before = &sys.ground();
  for (int k = 0; k < n; ++k) {
    Body& body = sys.add_body("rod " + std::to_string(k), {1.0, Vec3::Zero(), Vec3(0.08, 0.01, 0.09).asDiagonal()},
                              {Vec3(0, -0.5 - k, 0), {}});
    sys.add<Revolute>("joint " + std::to_string(k), body, *before, pose_at(Vec3(0, -k, 0)));
    before = &body;
  }
}

}  // namespace lockstep::modes_bench
