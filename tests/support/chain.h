// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <memory>
#include <string>

#include <lockstep/joints.h>

namespace lockstep::test {

/// Chain of n rods that hang on hinges, each about an axis that is turned against the one before by `twist`, rad.
inline std::unique_ptr<System> chain(int n, double twist = 0.0) {
  auto sys = std::make_unique<System>(System::Options{Vec3(0, 0, -9.81)});
  Body* before = &sys->ground();
  for (int i = 0; i < n; ++i) {
    const double x = i, mass = 1.0 + 0.05 * i;
    Body& rod =
        sys->add_body("rod " + std::to_string(i), {mass, Vec3::Zero(), (mass * Vec3(0.02, 0.09, 0.1)).asDiagonal()},
                      {Vec3(x + 0.5, 0, 0), Quat{}});
    const double angle = twist * i;
    sys->add<Revolute>("hinge " + std::to_string(i), rod, *before,
                       pose_at(Vec3(x, 0, 0), Vec3(std::sin(angle), std::cos(angle), 0)));
    before = &rod;
  }
  return sys;
}

}  // namespace lockstep::test
