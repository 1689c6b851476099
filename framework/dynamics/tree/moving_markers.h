// SPDX-License-Identifier: BSD-3-Clause
// Joints of the tree whose markers move on their bodies by laws: how they carry a slot.
#pragma once

#include <lockstep/state.h>
#include "framework/dynamics/tree/joint_tree.h"
#include "framework/dynamics/tree/moving_frame.h"
#include "framework/dynamics/tree/tree_motion.h"

namespace lockstep {

/// The values of the laws of a joint with moving markers at a time: of the markers, and those of its lock on what it
/// holds, along the axes of S and in those of D.
struct JointLaws {
  MarkerMotion near, far;
  ImposedTranslation x;
  ImposedRotation D;
};
/// Throws NonFiniteError and what the laws throw, with the link's name.
LOCKSTEP_API JointLaws joint_laws_at(const TreeNode&, double t, const VecX& s);

/// The motion of a node with moving markers from that of its parent, world axes.
struct MovedNode {
  Vec3 w,              ///< angular velocity of the slot, rad/s
      r,               ///< from the parent's centre of mass, m
      ca, cal;         ///< a = a_p + al_p x r + ca, al = al_p + cal where the coordinates' own accelerations are zero
  JointAxes<Vec3> at;  ///< its point: from the parent's centre of mass, m
};

/// Writes the motion of a node and returns what its joint adds. `wp`: angular velocity of the parent, world axes, rad/s.
/// Throws what the laws throw, with the link's name.
MovedNode carry_moving(const TreeNode&, const State&, const Motion& p, const Vec3& wp, Motion& out);
/// As JointMotion::vary.
NodeVariation vary_moving(const TreeNode&, const State&, const StateRate& dy, const Motion& p, const NodeVariation& dp);
/// The coordinates and velocities of a node with these motions at time t: translations along all axes of S, their rates;
/// r, and the turn's angular velocity, axes of P; laws of the lock taken off.
struct MovedCoordinates {
  Vec3 rho, rhod, w;
  Quat r;
};
MovedCoordinates read_moving(const TreeNode&, double t, const VecX& s, const Motion& p, const Motion& own);

}  // namespace lockstep
