// SPDX-License-Identifier: BSD-3-Clause
// LoopClosures: the rows of links that are not in the tree: read, eliminated along with the recursion, and measured.
#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include <lockstep/detail/rows.h>
#include "framework/dynamics/tree/closure_rows.h"
#include "framework/dynamics/tree/open_rows.h"

namespace lockstep {

/// What depends on the space, the Slots of the recursion do:
///
///     read_side(view, i, k, node, motion, diagonal)  Jacobian of row k on the i-th slot; adds J M^-1 J' to diagonal
///     move_to_joint(node, K)                         from the centre of mass to the node's point; returns what l gains
///     centre(node)                                   acceleration of the centre of mass
template <class Space>
class LoopClosures final : public ClosureRows {
 public:
  using Wrench = typename Space::Wrench;
  using Twist = typename Space::Twist;

  /// Sizes everything for this tree and the rows of its closures.
  void begin(const JointTree& tree, const System& system, ClosureFronts fronts) {
    const auto mass = [&](const TreeNode& n) { return system.slot(n.slot).mass; };
    const auto [lightest, heaviest] = std::ranges::minmax_element(tree.nodes(), {}, mass);
    ClosureRows::begin(std::move(fronts), system.length(), mass(*heaviest) / mass(*lightest));
    K_.assign(fronts_.rows.size(), {}), J_.assign(fronts_.sides.size(), {});
    wrenches_.assign(fronts_.n_nodes, {}), changes_.assign(fronts_.n_nodes, {});
    du_.setZero(tree.n_v());
  }

  /// Reads the rows, gathered at these motions; their right-hand sides c are Qhat. After the outward pass.
  template <class Slots>
  LOCKSTEP_INLINE void read(const Slots& slots, std::span<const Motion> motions, const RowTable& table) {
    OpenRows<Space> open = rows();
    open.clear();
    diagonal_.setZero();
    double arm2 = 0;
    for (const RowEntry& e : table.entries) {
      const RowView block = table.block(e);
      for (int k = 0; k < e.m; ++k) {
        const int row = e.first_row + k;
        c_[row] = block.Qhat(k);
        const ClosureSource& source = fronts_.sources[row];
        double l = -c_[row];
        for (int i = 0; i < source.n_sides; ++i) {
          const auto at = static_cast<std::size_t>(source.first_side + i);
          const ClosureSide& side = fronts_.sides[at];
          const auto node = static_cast<std::size_t>(side.node);
          const Motion& motion = motions[e.slots[i] + 1];
          Wrench& J = J_[at];
          J = slots.read_side(block, i, k, node, motion, diagonal_[row]);
          if (source.kind == RowKind::translation) arm2 = std::max(arm2, squares(J).second);
          Wrench K = J;
          l += slots.move_to_joint(node, K);
          K_[side.place] += K;
        }
        open.l_of(static_cast<std::size_t>(row)) = l;
      }
    }
    measure_scales(table, arm2);
  }

  /// After the recursion, or a correction: measures J a - c, and returns whether it is small enough.
  template <class Slots>
  LOCKSTEP_INLINE bool met(const Slots& slots, bool corrected) {
    for (const bool raised : {false, true}) {
      for (std::size_t j = 0; j < fronts_.sources.size(); ++j) {
        const ClosureSource& source = fronts_.sources[j];
        const auto row = static_cast<Eigen::Index>(j);
        const auto side = [&](std::size_t at, auto&& take) __attribute__((always_inline)) {
          take(J_[at], slots.centre(static_cast<std::size_t>(fronts_.sides[at].node)));
        };
        measure_row(source, raised, c_[row], r_[row], size_[row], side);
      }
      if (is_met(corrected)) return true;
    }
    return false;
  }

  const VecX& measured() const { return r_; }     ///< the residuals that met() has measured
  void add_correction() { lambda_ += dlambda_; }  ///< of them, as found last
  /// What the last correction changes, by node.
  const Twist* changes() const { return changes_.data(); }

  /// For the recursion; afterwards closed() takes what it has counted.
  LOCKSTEP_INLINE OpenRows<Space> rows() {
    return {fronts_,   K_.data(),      l_.data(),       Lambda_.data(), V_.data(),        scale_.data(),
            d_.data(), lambda_.data(), dlambda_.data(), du_.data(),     wrenches_.data(), changes_.data()};
  }
  LOCKSTEP_INLINE void closed(const OpenRows<Space>& rows) { n_small_ = static_cast<int>(rows.n_small); }

 private:
  std::vector<Wrench> K_,       // by place
      J_,                       // by side, of the slot's centre of mass
      wrenches_;                // of a correction, by node
  std::vector<Twist> changes_;  // likewise
};

}  // namespace lockstep
