// SPDX-License-Identifier: BSD-3-Clause
// The mechanisms that are no simple family, as data that any engine's model can be built from: Andrews' squeezing
// mechanism, Bricard's loop, the flyball governor. World axes, everything at the start.
#pragma once

#include <vector>

#include "tests/benchmark/peers/mechanisms.h"

namespace lockstep::peers {

inline constexpr int kGroundBody = -1;

/// Frame at the mass centre along the principal axes.
struct AssemblyBody {
  Mass mass;
  Vec3 x;
  Mat3 R = Mat3::Identity();
};
/// Of `child` on `parent`; every body is the child of one of them, parents come first.
struct TreeJoint {
  int parent, child;
  Vec3 at, axis;
  bool slides = false;
  double speed = 0;  ///< at the start
};
/// A revolute that closes a loop; `planar`: only its two rows in the x-y plane are needed.
struct ClosingJoint {
  int a, b;
  Vec3 at, axis;
  bool planar = false;
};
struct Spring {
  int a, b;
  Vec3 at_a, at_b;
  double stiffness, damping, free_length;
};
struct Assembly {
  std::vector<AssemblyBody> bodies;
  std::vector<TreeJoint> tree;
  std::vector<ClosingJoint> loops;
  std::vector<Spring> springs;
  double torque = 0;  ///< on body 0 about z, N m
};

/// Bodies in the order of the truth. Throws std::runtime_error for another mechanism.
Assembly assembly_of(const Mechanism&);

}  // namespace lockstep::peers
