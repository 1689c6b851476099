// SPDX-License-Identifier: BSD-3-Clause
// The six-axis arm: links 1 to 6 on revolute joints J1 to J6, a tool marker on the last.
#pragma once

#include <array>
#include <vector>

#include <lockstep/lockstep.h>

namespace lockstep::samples {

struct Arm {
  System sys{{.gravity = {0, 0, -9.81}}};
  std::vector<Revolute*> joints;
  Marker* tool = nullptr;
};

/// Links in the pose of the six angles q; joint k turns about its axis, placed at p in the frame of link k-1.
Arm make_arm(const std::array<double, 6>& q);

}  // namespace lockstep::samples
