// SPDX-License-Identifier: BSD-3-Clause
// Which links carry a slot from another: a spanning tree of the graph of links.
#pragma once

#include <vector>

namespace lockstep {

/// A link between two slots; kGround is one of them.
struct GraphLink {
  int number = 0;      ///< of the link
  int a = 0, b = 0;    ///< slots
  int rows = 0;        ///< unknowns that it takes away as a joint of a tree; 0: it is no joint of a tree
};

/// Whether each of these links is in the tree. Joints that hold most go first, so that few unknowns are left. Of equals
/// there are two trees: one grows from the slot that was reached last, along the shortest loop that it can close, the
/// other from the slot that was reached first. Taken is the one in which the paths on which closures carry their rows
/// are shorter: in a ladder the first, in a row of four-bars on the ground the second.
std::vector<bool> spanning_tree(const std::vector<GraphLink>&, int n_slots);

}  // namespace lockstep
