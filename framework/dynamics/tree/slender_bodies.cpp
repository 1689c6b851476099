// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/tree/slender_bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>

#include <lockstep/text.h>
#include "framework/dynamics/tree/joint_tree.h"

namespace lockstep {

std::string slender_body(const JointTree& tree, const System& system, double most) {
  if (tree.planar()) return "";
  const std::vector<TreeNode>& nodes = tree.nodes();
  std::vector<double> m(nodes.size(), 0.0), r2(nodes.size(), 0.0);
  std::string words;
  for (std::size_t k = nodes.size(); k-- > 0;) {
    const TreeNode& n = nodes[k];
    const Slot& slot = system.slot(n.slot);
    m[k] += slot.mass;
    if (n.link >= 0) r2[k] = std::max(r2[k], n.far_u.squaredNorm());
    if (n.parent >= 0) {
      const auto parent = static_cast<std::size_t>(n.parent);
      m[parent] += m[k], r2[parent] = std::max(r2[parent], n.near_u.squaredNorm());
    }
    if (n.turn != TreeTurn::ball || slot.freedoms == Freedoms::particle) continue;
    const double least = Eigen::SelfAdjointEigenSolver<Mat3>(slot.J, Eigen::EigenvaluesOnly).eigenvalues()[0];
    const double slenderness = m[k] * r2[k] / least;
    if (!(slenderness > most)) continue;
    most = slenderness;
    words = fmt::format(
        "body '{}' rotates about all axes with a least inertia of {} kg m^2 but carries {} kg on arms of {} m, so its "
        "rotation is lost in round-off",
        system.body_of_slot(n.slot).name, text::brief(least), text::brief(m[k]), text::brief(std::sqrt(r2[k])));
  }
  return words;
}

}  // namespace lockstep
