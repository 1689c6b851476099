// SPDX-License-Identifier: BSD-3-Clause
// TreePlan: a tree of joints on arrays of numbers of any type: what is equal for all states, and where the numbers of each
// node are.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "framework/dynamics/tree/inward_places.h"
#include "framework/dynamics/tree/joint_passes.h"
#include "framework/dynamics/tree/joint_tree.h"
#include "framework/dynamics/tree/number_arrays.h"
#include "framework/dynamics/tree/tree_layout.h"

namespace lockstep::numbers {

/// A node of the tree.
struct NumberNode : InwardPlace {
  int parent = -1, slot = 0;  ///< as those of the TreeNode
  std::size_t q = 0, v = 0;   ///< where its coordinates and velocities begin, among those of a state
  int n_slides = 0;           ///< as those of the TreeNode
  TreeTurn turn = TreeTurn::none;
  bool reversed = false;
  std::size_t joint = 0, more = 0, law = 0;  ///< numbers of its joint; of what only some joints have; of its laws
  bool has_law = false,                      ///< imposed
      moving = false;                        ///< its markers move on their bodies: marked, in place of imposed
  std::array<int, 3> slides{};               ///< of a joint with moving markers: axes of S along which it slides

  bool needs_more() const { return n_slides > 0 || turn == TreeTurn::ball || has_law || moving; }
  bool is_hinge() const { return turn == TreeTurn::hinge && n_slides == 0 && !has_law && !moving; }  ///< and no more
  int n_v() const { return n_slides + (turn == TreeTurn::none ? 0 : turn == TreeTurn::hinge ? 1 : 3); }
};

struct TreePlan {
  std::vector<NumberNode> nodes;  ///< parents before their children
  std::size_t n_q = 0, n_v = 0;
  std::size_t size_more = 0, size_law = 0;
  std::size_t n_waiting = 0;
  int normal = -1;  ///< of the plane in which all moves; -1: in space

  /// The axes of space in their order in arrays: the normal comes third.
  std::array<int, 3> axes() const {
    return normal < 0 ? std::array{0, 1, 2} : std::array{(normal + 1) % 3, (normal + 2) % 3, normal};
  }
};

/// Numbers of a joint: markers' origins | e = e_p (c K0 + s K1) | axis of a hinge | mass | inertia xx xy xz yy yz zz.
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

/// The arrays of a tree. A: an array of numbers (number_arrays.h).
template <class A>
struct TreeArrays {
  A y,                                 ///< state: q, v
      gravity,                         ///< 3
      wrench,                          ///< of the forces: 6 per slot; none: there are no forces
      joint, more, law, cosine, sine,  ///< of half the angle of each node
      moving;                          ///< the ground first

  template <class F>
  auto each(F&& f) const -> TreeArrays<decltype(f(y))> {
    return {f(y), f(gravity), f(wrench), f(joint), f(more), f(law), f(cosine), f(sine), f(moving)};
  }
};
/// What the recursion alone reads, a struct of numbers each: per node | per velocity | inertias that wait.
template <class G>
struct TreeNumbers : TreeArrays<typename G::Array> {
  Travel<typename G::Space>* travel;
  bodies::Coordinate<typename G::Space>* dof;
  typename G::Space::Inertia* waiting;
};

LOCKSTEP_API TreePlan make_plan(const TreeLayout&);

}  // namespace lockstep::numbers
