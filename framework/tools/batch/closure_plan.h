// SPDX-License-Identifier: BSD-3-Clause
// ClosurePlan: the rows that close the loops of a batch in joint coordinates: at which nodes they are open, and where the
// packs of each row are. Private to the room.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "framework/dynamics/solvers/scales.h"
#include "framework/dynamics/tree/tree_layout.h"
#include "framework/tools/batch/lane_plan.h"
#include "framework/tools/batch/tree_plan.h"

namespace lockstep::lanes {

/// A slot of a row, in the order of ClosureFronts::sides.
struct ClosureSlot {
  std::size_t J = 0;  ///< of the row in RowArrays::J, column after column,
  std::size_t m = 0;  ///< so far apart
  std::size_t node = 0;
};

/// A link that closes a loop: its rows.
struct ClosureLink {
  std::size_t first_row = 0;
  int m = 0;
  KindBits kinds;
};

/// A link whose rows its own code writes, copy by copy: of functions, or with markers that laws move.
struct OwnRows {
  int link = 0;  ///< in the system
  std::size_t first_row = 0, m = 0, n_sides = 0;
  std::array<int, kMaxRows> own{};  ///< the link's own number of each row
  std::size_t J = 0;                ///< of its first side; the others follow
};

/// What is equal in all copies.
struct ClosurePlan {
  ClosureFronts fronts;
  std::vector<Link> masks;  ///< rows of a link along the axes of S, c and C from `x` on
  std::vector<OwnRows> own;
  std::vector<ClosureLink> links;
  std::vector<ClosureSlot> slots;
  struct Seen {
    std::size_t slot = 0, node = 0;
  };
  std::vector<Seen> seen;  ///< slots that the rows touch
  std::size_t n_slots = 0, size_J = 0, size_frames = 0, size_law = 0;
  int normal = -1;  ///< of the plane in which the tree and the rows lie; -1: in space

  std::size_t n_rows() const { return fronts.sources.size(); }
  bool empty() const { return fronts.sources.empty(); }
};

/// The plan of copies whose rows are laid out like these.
ClosurePlan make_closure_plan(const System&, const TreeLayout&);
/// Whether the rows of two copies, the trees of which are alike, are laid out alike.
bool are_alike(const System&, const TreeLayout&, const System&, const TreeLayout&);

/// Rows of links (lane_rows.h): motions of bodies, markers, laws; what is written.
template <class A>
struct RowArrays {
  A body, frames, law, J, c, C, Ct;

  template <class F>
  LOCKSTEP_INLINE auto each(F&& f) const -> RowArrays<decltype(f(body))> {
    return {f(body), f(frames), f(law), f(J), f(c), f(C), f(Ct)};
  }
};
/// The arrays of closures, as TreeArrays. Per side: J, world axes | per place: l | per front: Lambda, V | per row | per
/// velocity, of a correction.
template <class A>
struct ClosureArrays {
  RowArrays<A> rows;
  A inverse,  ///< 1/m | J^-1 xx xy xz yy yz zz, per node
      J, l, Lambda, V, diagonal, scale, d, lambda, dlambda, r, size, Cd, du;

  template <class F>
  LOCKSTEP_INLINE auto each(F&& f) const -> ClosureArrays<decltype(f(J))> {
    return {rows.each(f), f(inverse), f(J),       f(l), f(Lambda), f(V),  f(diagonal), f(scale),
            f(d),         f(lambda),  f(dlambda), f(r), f(size),   f(Cd), f(du)};
  }
};
/// A struct of numbers each: per place: K | of a correction, per node.
template <class G>
struct ClosureNumbers : ClosureArrays<typename G::Array> {
  typename G::Space::Wrench *K, *wrench;
  typename G::Space::Twist* change;
};
struct ClosureStore : ClosureArrays<std::span<double>> {
  std::span<double> K, wrench, change;  ///< those of one round after another
};
/// Copies of a tree with its closures: what is equal in all of them, and their numbers.
struct LaneData {
  TreePlan plan;
  TreeStore z{};
  ClosurePlan loops;
  ClosureStore c{};
};

}  // namespace lockstep::lanes
