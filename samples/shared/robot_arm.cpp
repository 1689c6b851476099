// SPDX-License-Identifier: BSD-3-Clause
#include "samples/shared/robot_arm.h"

#include <spdlog/fmt/fmt.h>

namespace lockstep::samples {

Arm make_arm(const std::array<double, 6>& q) {
  const std::array<Vec3, 6> axis{Vec3::UnitZ(), Vec3::UnitY(), Vec3::UnitY(),
                                 Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitX()};
  const std::array<Vec3, 6> p{Vec3(0, 0, .2), Vec3(0, 0, .2),  Vec3(.45, 0, 0),
                              Vec3(.4, 0, 0), Vec3(.12, 0, 0), Vec3(.09, 0, 0)};
  const std::array<Vec3, 6> com{Vec3(0, 0, .1),  Vec3(.22, 0, .03), Vec3(.18, .02, 0),
                                Vec3(.06, 0, 0), Vec3(.04, 0, .01), Vec3(.03, .01, 0)};
  const std::array<double, 6> m{8, 6, 4, 2, 1.2, .6};
  const std::array<Vec3, 6> J{Vec3(.08, .08, .05),    Vec3(.02, .12, .12),     Vec3(.01, .06, .06),
                              Vec3(.003, .005, .005), Vec3(.0015, .002, .002), Vec3(.0004, .0006, .0006)};
  Arm arm;
  Body* previous = &arm.sys.ground();
  Pose home;
  for (std::size_t k = 0; k < 6; ++k) {
    home = home * Pose{p[k], axis_angle(axis[k], q[k])};
    Body& link = arm.sys.add_body(fmt::format("link_{}", k + 1), {m[k], com[k], J[k].asDiagonal()}, home);
    // P and S have their z along the joint's axis; P turns with the link, so the angle starts at q.
    const Quat z_to_axis = pose_at({0, 0, 0}, axis[k]).q;
    Marker& P = arm.sys.add_marker(fmt::format("p{}", k + 1), link, {{0, 0, 0}, z_to_axis});
    Marker& S = arm.sys.add_marker(fmt::format("s{}", k + 1), *previous, {p[k], z_to_axis});
    arm.joints.push_back(&arm.sys.add<Revolute>(fmt::format("J{}", k + 1), P, S));
    previous = &link;
  }
  arm.tool = &arm.sys.add_marker("tool", *previous, {{0.08, 0, 0}, {}});
  return arm;
}

}  // namespace lockstep::samples
