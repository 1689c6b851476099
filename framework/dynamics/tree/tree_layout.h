// SPDX-License-Identifier: BSD-3-Clause
// TreeLayout: joint coordinates of a mechanism, the rows of what closes loops, and where these are eliminated.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <lockstep/detail/rows.h>
#include "framework/dynamics/tree/closure_fronts.h"
#include "framework/dynamics/tree/joint_tree.h"

namespace lockstep {

/// Which mechanisms are taken.
enum class Taken {
  trees,          ///< without rows in addition to their joints
  where_cheaper,  ///< trees, and loops that cost less along the tree than in omega: why_dearer()
  all             ///< that have joint coordinates
};

/// Without a tree the rows and their fronts are those of none.
struct TreeLayout {
  std::shared_ptr<const JointTree> tree;  ///< null: joint coordinates are not taken
  std::string why_not;                    ///< the reason if there is none; "" otherwise
  RowTable closures;  ///< rows of the links that close loops, and those that joints of the tree leave
  ClosureFronts fronts;
};

/// Of a system that is set up, with these links in force.
LOCKSTEP_API TreeLayout lay_out_tree(const System&, const std::vector<bool>& modes, Taken);

}  // namespace lockstep
