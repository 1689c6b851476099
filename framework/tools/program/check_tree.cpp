// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/check_tree.h"

#include <lockstep/author/lock.h>
#include "framework/dynamics/tree/joint_tree.h"

namespace lockstep {
namespace {

// The coordinates that a lock leaves free and nothing drives; in a plane those in it, by the axes of S that lie in it
// or along its normal, else of the world.
std::vector<std::string> free_axes(const TreeNode& n, Plane plane) {
  std::vector<std::string> free;
  if (!plane) {
    for (const Axis axis : {Axis::x, Axis::y, Axis::z, Axis::rx, Axis::ry, Axis::rz})
      if (!includes(n.rows, row_of(axis)) &&
          !(is_rotation(axis) && n.turn == TreeTurn::none))  // particles do not rotate
        free.emplace_back(to_string(axis));
    return free;
  }
  const Mat3 S = rotation(n.reversed ? n.far_q : n.near_q);
  const auto axis_of = [](const Mat3& axes, const Vec3& along) -> std::string {
    for (int k = 0; k < 3; ++k)
      if (are_parallel(axes.col(k), along, 1e-9)) return std::string(1, "xyz"[k]);
    return "";
  };
  for (int k = 0; k < n.n_slides; ++k) {
    const Vec3& along = n.slide(k);
    const std::string own = axis_of(S, along), world = axis_of(Mat3::Identity(), along);
    free.push_back(!own.empty() ? own : !world.empty() ? "world " + world : "normal to the constraints");
  }
  if (n.turn != TreeTurn::none) {
    const std::string own = axis_of(Mat3::Identity(), n.hinge);
    free.push_back(own.empty() ? "about the normal" : "r" + own);
  }
  return free;
}

}  // namespace

TreeReport tree_of(const System& system, const std::vector<bool>& modes) {
  std::string why_not;
  const std::shared_ptr<const JointTree> tree = JointTree::of(system, modes, why_not);
  TreeReport report;
  if (!tree) return report;
  report.n_coordinates = tree->n_v();
  for (const TreeNode& n : tree->nodes()) {
    Branch b;
    b.body = system.body_of_slot(n.slot).name;
    if (n.link >= 0) b.parent = n.parent >= 0 ? report.branches[n.parent].body : "ground";
    const Lock* link = n.link >= 0 ? system.links()[n.link].get() : nullptr;
    if (link != nullptr) b.link = link->name();
    b.coordinates = free_axes(n, system.plane());
    for (int row = 0; link != nullptr && row < link->row_count(); ++row)
      if ((n.left >> row & 1U) != 0) {
        b.rows.push_back(link->row_name(row));
        report.left.push_back(b.link + "." + b.rows.back());
      }
    report.branches.push_back(std::move(b));
  }
  for (const int link : tree->closures()) report.closures.push_back(system.links()[link]->name());
  return report;
}

const Fields<Branch>& branch_fields() {
  static const Fields<Branch> kFields{{"body", "", "body", &Branch::body},
                                      {"parent", "", "on", &Branch::parent},
                                      {"link", "", "by joint", &Branch::link},
                                      {"coordinates", "", "coordinates", &Branch::coordinates},
                                      {"held", "", "prescribed", [](const Branch& b) { return b.coordinates.empty(); }},
                                      {"rows", "", "constraints left", &Branch::rows}};
  return kFields;
}

}  // namespace lockstep
