// SPDX-License-Identifier: BSD-3-Clause
// TreePlan: the tree of a batch in joint coordinates, and where the packs of each node are. Private to the room.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "framework/dynamics/tree/inward_places.h"
#include "framework/dynamics/tree/joint_passes.h"
#include "framework/dynamics/tree/joint_tree.h"
#include "framework/tools/batch/lane_plan.h"
#include "framework/tools/batch/number_arrays.h"

namespace lockstep::lanes {

/// A node of the tree: what is equal in all copies.
struct LaneNode : InwardPlace {
  int parent = -1, slot = 0;  ///< as those of the TreeNode
  std::size_t q = 0, v = 0;   ///< where its coordinates and velocities begin, among those of a state
  int n_slides = 0;           ///< as those of the TreeNode
  TreeTurn turn = TreeTurn::none;
  bool reversed = false;
  std::size_t joint = 0, more = 0, law = 0;  ///< packs of its joint; of what only some joints have; of its laws
  bool has_law = false,                      ///< imposed
      moving = false;                        ///< its markers move on their bodies: marked, in place of imposed
  std::array<int, 3> slides{};               ///< of a joint with moving markers: axes of S along which it slides

  bool needs_more() const { return n_slides > 0 || turn == TreeTurn::ball || has_law || moving; }
  bool is_hinge() const { return turn == TreeTurn::hinge && n_slides == 0 && !has_law && !moving; }  ///< and no more
  int n_v() const { return n_slides + (turn == TreeTurn::none ? 0 : turn == TreeTurn::hinge ? 1 : 3); }
};

struct TreePlan {
  std::vector<LaneNode> nodes;  ///< parents before their children
  std::size_t n_q = 0, n_v = 0;
  std::size_t size_more = 0, size_law = 0;
  std::size_t n_waiting = 0;
  int normal = -1;  ///< of the plane in which all moves; -1: in space

  /// The axes of space in their order in arrays: the normal comes third.
  std::array<int, 3> axes() const {
    return normal < 0 ? std::array{0, 1, 2} : std::array{(normal + 1) % 3, (normal + 2) % 3, normal};
  }
};

/// Packs of a joint: markers' origins | e = e_p (c K0 + s K1) | axis of a hinge | mass | inertia xx xy xz yy yz zz.
namespace joint {
inline constexpr std::size_t near = 0, far = 3, K0 = 6, K1 = 10, axis = 14, m = 17, J = 18, size = 24;
}
/// Directions of translations | axes of a ball, row after row | axes of near and far, and of a hinge among those of D.
namespace more {
inline constexpr std::size_t slide = 0, ball = 9, near_q = 18, far_q = 22, hinge = 26, size = 29;
}
/// Laws: Imposed.
namespace imposed {
inline constexpr std::size_t p = 0, pd = 3, pdd = 6, w = 9, a = 12, axis = 15, q = 18, size = 22;
}
/// Laws of a joint with moving markers: those of near, those of far, and those of its lock on what it holds, each a
/// translation with its rates | q | w, a, in the axes that it turns.
namespace marked {
inline constexpr std::size_t u = 0, ud = 3, udd = 6, q = 9, w = 13, a = 16, one = 19;
inline constexpr std::size_t near = 0, far = one, lock = 2 * one, size = 3 * one;
}  // namespace marked
/// Of a slot, world axes: e | A, row after row | w | x | v | a | al.
namespace moving {
inline constexpr std::size_t e = 0, A = 4, w = 13, x = 16, v = 19, a = 22, al = 25, size = 28;
}
/// From the parent's point to that of a node, and its acceleration beyond the parent's if the coordinates' are zero.
template <class Space>
struct Travel {
  typename Space::Linear r;
  typename Space::Twist c;
};
/// Packs of a struct of numbers.
namespace struct_size {
inline constexpr std::size_t travel = 9, coordinate = 14, inertia = 27, wrench = 6;  // a twist as a wrench
}

/// The end of a step, of a slot: x | e | v | w, slot axes.
namespace end {
inline constexpr std::size_t x = 0, e = 3, v = 7, w = 10, size = 13;
}
/// How an error of the coordinates moves a slot, world axes: of x, a rotation vector, of v, of w.
namespace varied {
inline constexpr std::size_t x = 0, phi = 3, v = 6, w = 9, size = 12;
}

/// The arrays of a batch in joint coordinates. A: an array of numbers (number_arrays.h); where they are stored: a span.
template <class A>
struct TreeArrays {
  A y,                                 ///< state: q, v, s
      gravity,                         ///< 3
      wrench,                          ///< of the forces: 6 per slot; none: there are no forces
      joint, more, law, cosine, sine,  ///< of half the angle of each node
      moving,                          ///< the ground first
      largest,                         ///< |a|^2, |al|^2 of the slot that has most
      varied;                          ///< the ground first
  bool with_positions;                 ///< x and v of the slots are asked for

  template <class F>
  LOCKSTEP_INLINE auto each(F&& f) const -> TreeArrays<decltype(f(y))> {
    return {f(y),      f(gravity), f(wrench), f(joint),   f(more),   f(law),
            f(cosine), f(sine),    f(moving), f(largest), f(varied), with_positions};
  }
};
/// What the recursion alone reads, a struct of numbers each: per node | per velocity | inertias that wait.
template <class G>
struct TreeNumbers : TreeArrays<typename G::Array> {
  Travel<typename G::Space>* travel;
  bodies::Coordinate<typename G::Space>* dof;
  typename G::Space::Inertia* waiting;
};
struct TreeStore : TreeArrays<std::span<double>> {
  std::span<double> travel, dof, waiting;  ///< those of one round after another
};

}  // namespace lockstep::lanes
