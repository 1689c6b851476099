// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/tree/tree_reactions.h"

#include <array>

namespace lockstep {

void TreeReactions::begin(const JointTree& tree, const System& system, const RowTable& rows) {
  carried_.assign(tree.nodes().size(), {});
  node_of_link_.assign(system.links().size(), -1);
  for (std::size_t k = 0; k < tree.nodes().size(); ++k)
    if (const int link = tree.nodes()[k].link; link >= 0) node_of_link_[link] = static_cast<int>(k);
  lambda_.setZero(rows.n_rows);
  length_ = system.length();
}

void TreeReactions::solve(const JointTree& tree, const System& system, std::span<const Motion> motions, const VecX& a,
                          const VecX& f, const RowTable& rows) {
  wrenches(tree, system, motions, a, f);
  for (const RowEntry& e : rows.entries) {
    if (node_of_link_[e.link] < 0) continue;
    const auto node = static_cast<std::size_t>(node_of_link_[e.link]);
    const TreeNode& n = tree.nodes()[node];
    multipliers(e, rows, motions[n.slot + 1], carried_[node], system.slot(n.slot), n);
  }
}

void TreeReactions::set(const RowEntry& e, const RowEntry& other, const VecX& lambda) {
  int next = 0;
  for (int k = 0; k < e.m; ++k) {
    const bool there = next < other.m && other.own[next] == e.own[k];
    lambda_[e.first_row + k] = there ? lambda[other.first_row + next++] : 0.0;
  }
}

// m a = F + what the joint carries - what the joints of the children carry; likewise about the centre of mass:
//   J w' + w x J w = M + ...   with f = (F, M - w x J w)
void TreeReactions::wrenches(const JointTree& tree, const System& system, std::span<const Motion> motions,
                             const VecX& a, const VecX& f) {
  for (Wrench& w : carried_) w = {};
  for (std::size_t k = carried_.size(); k-- > 0;) {
    const TreeNode& n = tree.nodes()[k];
    const Motion& own = motions[n.slot + 1];
    const Slot& slot = system.slot(n.slot);
    Wrench& w = carried_[k];
    w.force += slot.mass * a.segment<3>(6 * n.slot) - f.segment<3>(6 * n.slot);
    w.moment += own.A * (slot.J * a.segment<3>(6 * n.slot + 3) - f.segment<3>(6 * n.slot + 3));
    if (n.parent < 0) continue;
    const int parent = tree.nodes()[n.parent].slot;
    Wrench& p = carried_[n.parent];
    p.force += w.force;
    const Vec3 r = own.x - motions[parent + 1].x;
    p.moment += w.moment + cross(r, w.force);
  }
}

// -J' lambda = (F, A' M) on the slot: six equations for at most six multipliers, which have one solution, since a joint
// carries nothing along its free coordinates; three for a particle. Rows that the joint does not hold are forces. Moments
// are divided by a length, as everywhere in norms. Jt = Q R by Gram and Schmidt's modified method, which takes of the
// right-hand side what each column of Q has of it: as exact as reflections.
void TreeReactions::multipliers(const RowEntry& e, const RowTable& rows, const Motion& motion, const Wrench& carried,
                                const Slot& of, const TreeNode& n) {
  std::array<int, 6> held{};
  int m = 0;
  for (int k = 0; k < e.m; ++k)
    if ((n.left >> e.own[k] & 1U) == 0) held[m++] = k;
  const RowView block = rows.block(e);
  const int i = e.slots[0] == n.slot ? 0 : 1;
  const double turns = of.freedoms == Freedoms::particle ? 0.0 : 1.0 / length_;
  Vec6 wrench;
  wrench << -carried.force, -turns * (motion.A.transpose() * carried.moment);
  std::array<Vec6, 6> Q;
  std::array<double, 36> R;
  std::array<double, 6> x;
  for (int k = 0; k < m; ++k) {
    const std::array<double, 6> J = block.J(i, held[k]);
    Q[k] << J[0], J[1], J[2], turns * J[3], turns * J[4], turns * J[5];
    for (int j = 0; j < k; ++j) Q[k] -= (R[6 * j + k] = Q[j].dot(Q[k])) * Q[j];
    Q[k] /= R[7 * k] = Q[k].norm();
    wrench -= (x[k] = Q[k].dot(wrench)) * Q[k];
  }
  for (int k = m; k-- > 0;) {
    for (int j = k + 1; j < m; ++j) x[k] -= R[6 * k + j] * x[j];
    x[k] /= R[7 * k];
    lambda_[e.first_row + held[k]] = x[k];
  }
}

}  // namespace lockstep
