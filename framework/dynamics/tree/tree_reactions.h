// SPDX-License-Identifier: BSD-3-Clause
// TreeReactions: the multipliers of the joints of a tree.
#pragma once

#include <span>
#include <vector>

#include <lockstep/detail/rows.h>
#include <lockstep/system.h>
#include "framework/dynamics/tree/joint_tree.h"

namespace lockstep {

/// What the rows of a tree's links would give if they were solved for: from known accelerations by the equations of
/// Newton and Euler, from the leaves to the roots (Featherstone 2008, section 5.3).
class TreeReactions {
 public:
  /// Sizes everything for this tree and the rows of its links in force.
  void begin(const JointTree&, const System&, const RowTable&);
  /// With the accelerations a under the forces f, 6 per slot, as in Evaluated, and the rows gathered at the same state.
  /// Links of the table that are no joints of the tree, and rows that joints do not hold, act by f, and keep the
  /// multipliers that were set.
  void solve(const JointTree&, const System&, std::span<const Motion> motions, const VecX& a, const VecX& f,
             const RowTable& rows);

  const VecX& lambda() const { return lambda_; }  ///< one per row of the table
  /// Sets the multipliers of a link of the table to those of its rows in another table, which may lack some; these are
  /// zero.
  void set(const RowEntry&, const RowEntry& other, const VecX& lambda);

 private:
  // What the joint of a node carries onto its slot, about the centre of mass, world axes.
  struct Wrench {
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  };
  void wrenches(const JointTree&, const System&, std::span<const Motion> motions, const VecX& a, const VecX& f);
  void multipliers(const RowEntry&, const RowTable&, const Motion&, const Wrench&, const Slot&, const TreeNode&);

  std::vector<Wrench> carried_;    // by node
  std::vector<int> node_of_link_;  // by number of the link; -1: none
  VecX lambda_;
  double length_ = 1;
};

}  // namespace lockstep
