// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/tree/tree_layout.h"

#include <utility>

#include "framework/dynamics/tree/joint_cost.h"
#include "framework/dynamics/tree/rows_in_plane.h"
#include "framework/dynamics/tree/slender_bodies.h"
#include "framework/mechanism/system/lay_out.h"

namespace lockstep {

namespace {

// What prevents the elimination of these rows along a tree; "" if nothing does.
std::string obstacle_of_rows(const System& system, const RowTable& rows) {
  if (rows.held > 0) return "nearly redundant constraints are kept";
  for (const RowEntry& e : rows.entries)
    if (e.slots.n == 0) return "joint '" + system.links()[e.link]->name() + "' touches no moving body";
  return "";
}

// The rows of the links that close loops, and those that joints of the tree do not hold.
RowTable rows_beside(const JointTree& tree, const System& system, std::size_t n_links) {
  std::vector<bool> shown(n_links, false);
  std::vector<unsigned> absent(n_links, 0U);
  for (const int link : tree.closures()) shown[link] = true;
  for (const TreeNode& n : tree.nodes())
    if (n.left != 0) shown[n.link] = true, absent[n.link] = ~n.left & ((1U << n.lock->row_count()) - 1);
  RowTable table;
  lay_out_without(absent, system, shown, table);
  return table;
}

}  // namespace

TreeLayout lay_out_tree(const System& system, const std::vector<bool>& modes, Taken taken) {
  TreeLayout out;
  std::shared_ptr<const JointTree> tree = JointTree::of(system, modes, out.why_not);
  if (!tree) return out;
  if (taken != Taken::all) out.why_not = slender_body(*tree, system);
  if (!out.why_not.empty() || (taken == Taken::trees && tree->has_rows())) return out;
  if (tree->has_rows()) {
    RowTable closures = rows_beside(*tree, system, modes.size());
    out.why_not = obstacle_of_rows(system, closures);
    if (!out.why_not.empty()) return out;
    const bool in_plane = tree->planar() && (system.plane() || leave_out_normal_rows(*tree, system, closures));
    ClosureFronts fronts(*tree, system, closures);
    fronts.in_plane = in_plane;
    if (taken == Taken::where_cheaper) out.why_not = why_dearer(*tree, fronts, closures, system, modes);
    if (!out.why_not.empty()) return out;
    out.closures = std::move(closures), out.fronts = std::move(fronts);
  }
  out.tree = std::move(tree);
  return out;
}

}  // namespace lockstep
