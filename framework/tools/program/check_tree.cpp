// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/check_tree.h"

#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>

#include <lockstep/author/lock.h>
#include <lockstep/text.h>
#include "framework/dynamics/tree/joint_tree.h"

namespace lockstep {
namespace {

constexpr std::size_t kMostLines = 40;

// The coordinates that a lock leaves free and nothing drives; in a plane those in it, by the axes of S that lie in it or
// along its normal, else of the world.
std::vector<std::string> free_axes(const TreeNode& n, Plane plane) {
  std::vector<std::string> free;
  if (!plane) {
    for (const Axis axis : {Axis::x, Axis::y, Axis::z, Axis::rx, Axis::ry, Axis::rz})
      if (!includes(n.rows, row_of(axis)) && !(is_rotation(axis) && n.turn == TreeTurn::none))  // particles do not turn
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
    free.push_back(!own.empty() ? own : !world.empty() ? "the world's " + world : "across what is held");
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
    b.parent = "ground";
    if (n.parent >= 0) {
      const Branch& parent = report.branches[n.parent];
      b.parent = parent.body, b.depth = parent.depth + 1;
    }
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

std::string tree_text(const std::vector<Branch>& tree) {
  std::string text;
  for (std::size_t i = 0; i < tree.size() && i < kMostLines; ++i) {
    const Branch& b = tree[i];
    const std::string on = b.link.empty() ? "on no link" : fmt::format("on {} by '{}'", b.parent, b.link);
    text += fmt::format("{:{}}{} {}: {}{}\n", "", 2 * (1 + b.depth), b.body, on,
                        b.coordinates.empty() ? "driven throughout, or held" : text::join(b.coordinates),
                        b.rows.empty() ? "" : ", and row " + text::join(b.rows));
  }
  if (tree.size() > kMostLines) text += fmt::format("  and {} more, see --json\n", tree.size() - kMostLines);
  return text;
}

nlohmann::ordered_json tree_json(const std::vector<Branch>& tree) {
  auto all = nlohmann::ordered_json::array();
  for (const Branch& b : tree) {
    all.push_back(
        {{"body", b.body}, {"parent", nullptr}, {"link", nullptr}, {"coordinates", b.coordinates}, {"rows", b.rows}});
    if (!b.link.empty()) all.back()["parent"] = b.parent, all.back()["link"] = b.link;
  }
  return all;
}

}  // namespace lockstep
