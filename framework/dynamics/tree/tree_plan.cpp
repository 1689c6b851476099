// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/tree/tree_plan.h"

#include <algorithm>

namespace lockstep::numbers {

namespace {

// The normal of the plane in which a tree moves with the rows that close its loops, where the axes of its slots lie along it;
// -1: in space.
int plane_of(const TreeLayout& layout) {
  const PlanarJoints* const planar = layout.tree->planar();
  const bool rows_lie_in = layout.fronts.sources.empty() || layout.fronts.in_plane;
  if (!planar || !rows_lie_in) return -1;
  const auto lies_along = [](const PlanarNode& n) { return n.posture < 0; };
  return std::ranges::all_of(planar->nodes(), lies_along) ? planar->plane().n : -1;
}

}  // namespace

TreePlan make_plan(const TreeLayout& layout) {
  const JointTree& tree = *layout.tree;
  TreePlan plan;
  plan.normal = plane_of(layout);
  plan.n_q = static_cast<std::size_t>(tree.n_q()), plan.n_v = static_cast<std::size_t>(tree.n_v());
  for (const TreeNode& t : tree.nodes()) {
    NumberNode n;
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

}  // namespace lockstep::numbers
