// SPDX-License-Identifier: BSD-3-Clause
// ClosurePlan: the rows that close loops, on arrays of numbers of any type: at which nodes they are open, and where the
// numbers of each row are.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "framework/dynamics/solvers/scales.h"
#include "framework/dynamics/tree/tree_layout.h"
#include "framework/dynamics/tree/tree_plan.h"

namespace lockstep::numbers {

/// How the rotational half of a link is calculated.
enum class Turn : unsigned char { none, parallel, plain, law };

/// Where the data of one link are.
struct Link {
  int link = 0;        ///< in the system
  int m = 0;           ///< rows
  bool moved = false;  ///< a law moves its translation
  Turn turn = Turn::none;
  std::array<int, 6> row{};           ///< row k is this row of the lock
  int P = 0, S = 0;                   ///< slots; the ground is the number of slots
  std::ptrdiff_t J_P = -1, J_S = -1;  ///< of its Jacobians; -1: the ground
  std::size_t frames = 0;             ///< of its markers, frames::size numbers
  std::size_t law = 0;                ///< of its laws, law::size numbers, where there are any
  std::size_t x = 0;                  ///< of its rows

  bool has_laws() const { return moved || turn == Turn::law; }
};

/// Of a body: x 3 | A 9 | e 4 | v 3 | w 3, slot axes | w 3, world.
namespace body {
inline constexpr std::size_t x = 0, A = 3, e = 12, v = 16, w = 19, W = 22, size = 25;
}
/// Markers of a link: P: u 3 | q 4 | A 9, S the same.
namespace frames {
inline constexpr std::size_t uP = 0, qP = 3, AP = 7, uS = 16, qS = 19, AS = 23, size = 32;
}
/// Laws of a link: p, pd, pdd | q_D | A_D | w, a.
namespace law {
inline constexpr std::size_t p = 0, pd = 3, pdd = 6, q = 9, A = 13, w = 22, a = 25, size = 28;
}

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

/// A link whose rows its own code writes: of functions, or with markers that laws move.
struct OwnRows {
  int link = 0;  ///< in the system
  std::size_t first_row = 0, m = 0, n_sides = 0;
  std::array<int, kMaxRows> own{};  ///< the link's own number of each row
  std::size_t J = 0;                ///< of its first side; the others follow
};

/// What is equal for all states.
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

LOCKSTEP_API ClosurePlan make_closure_plan(const System&, const TreeLayout&);

/// Rows of links (number_rows.h): motions of bodies, markers, laws; what is written.
template <class A>
struct RowArrays {
  A body, frames, law, J, c;

  template <class F>
  auto each(F&& f) const -> RowArrays<decltype(f(body))> {
    return {f(body), f(frames), f(law), f(J), f(c)};
  }
};
/// The arrays of closures, as TreeArrays. Per side: J, world axes | per place: l | per front: Lambda, V | per row.
template <class A>
struct ClosureArrays {
  RowArrays<A> rows;
  A inverse,  ///< 1/m | J^-1 xx xy xz yy yz zz, per node
      J, l, Lambda, V, diagonal, scale, d, lambda;

  template <class F>
  auto each(F&& f) const -> ClosureArrays<decltype(f(J))> {
    return {rows.each(f), f(inverse), f(J), f(l), f(Lambda), f(V), f(diagonal), f(scale), f(d), f(lambda)};
  }
};
/// Per place: K.
template <class G>
struct ClosureNumbers : ClosureArrays<typename G::Array> {
  typename G::Space::Wrench* K;
};

}  // namespace lockstep::numbers
