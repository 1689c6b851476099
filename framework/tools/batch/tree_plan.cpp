// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/batch/tree_plan.h"

namespace lockstep::lanes {

TreePlan make_plan(const JointTree& tree, int normal) {
  TreePlan plan;
  plan.normal = normal;
  plan.n_q = static_cast<std::size_t>(tree.n_q()), plan.n_v = static_cast<std::size_t>(tree.n_v());
  for (const TreeNode& t : tree.nodes()) {
    LaneNode n;
    n.parent = t.parent, n.slot = t.slot;
    n.q = static_cast<std::size_t>(t.first_q), n.v = static_cast<std::size_t>(t.first_v);
    n.n_slides = t.n_slides, n.turn = t.turn, n.reversed = t.reversed;
    n.moving = t.moving != nullptr, n.has_law = t.imposed && !n.moving;
    n.joint = joint::size * plan.nodes.size();
    if (n.needs_more()) n.more = plan.size_more, plan.size_more += more::size;
    if (n.has_law || n.moving) n.law = plan.size_law, plan.size_law += n.moving ? marked::size : imposed::size;
    for (int axis = 0, k = 0; n.moving && axis < 3; ++axis)
      if (!includes(t.rows, row_bit(axis))) n.slides[k++] = axis;
    plan.nodes.push_back(n);
  }
  const std::vector<InwardPlace> places = inward_places(plan.nodes, plan.n_waiting);
  for (std::size_t k = 0; k < places.size(); ++k) static_cast<InwardPlace&>(plan.nodes[k]) = places[k];
  return plan;
}

}  // namespace lockstep::lanes
