// SPDX-License-Identifier: BSD-3-Clause
// NumberClosures: rows that close loops, eliminated along with the recursion (open_rows.h) on arrays of any numbers.
#pragma once

#include "framework/dynamics/tree/open_rows.h"
#include "framework/dynamics/tree/closure_plan.h"
#include "framework/dynamics/tree/number_rows.h"
#include "framework/dynamics/tree/number_tree.h"

namespace lockstep::numbers {

template <class G>
struct NumberClosures {
  using Tree = NumberTree<G>;
  using Array = typename G::Array;
  using T = typename G::T;
  using M3 = typename G::M3;
  using W = typename G::W;
  using Space = typename G::Space;
  using Wrench = typename Space::Wrench;
  using Twist = typename Space::Twist;
  using Rows = OpenRows<Space, Array>;

  const Tree tree;
  const ClosurePlan& plan;
  const ClosureNumbers<G> c;

  // ------------------------------------------------------------------------------------------------------------ rows

  LOCKSTEP_INLINE void gather() const {
    show_bodies();
    for (const Link& link : plan.masks) LinkRows<Array>(link, c.rows).write();
    read_jacobians();
  }

  // ----------------------------------------------------------------------------------------------------- elimination

  LOCKSTEP_INLINE void accelerate(const Array& rate) const {
    gather();
    Rows rows = begin();
    tree.accelerate(rate, rows);
  }

 private:
  template <class F>
  LOCKSTEP_INLINE void for_sides(std::size_t row, F&& f) const {
    const ClosureSource& source = plan.fronts.sources[row];
    for (int i = 0; i < source.n_sides; ++i) {
      const auto at = static_cast<std::size_t>(source.first_side + i);
      f(at, plan.slots[at]);
    }
  }
  LOCKSTEP_INLINE Wrench J_of(std::size_t side) const {
    const Array J = c.J + 6 * side;
    return {Space::from(G::linear(J, 0)), Space::from_axial(G::axial(J, 3))};
  }
  // The motions of the slots that rows touch, for LinkRows: in the axes of space.
  LOCKSTEP_INLINE void show_bodies() const {
    const std::array<int, 3> axes = tree.plan.axes();
    for (const ClosurePlan::Seen& s : plan.seen) {
      const Array b = tree.moving_at(static_cast<std::ptrdiff_t>(s.node)), out = c.rows.body + body::size * s.slot;
      const M3 A = G::matrix(b, moving::A);
      const auto w = to<VectorIn<Array>>(transpose_times(A, G::axial(b, moving::w)));
      out[body::e] = b[moving::e];
      for (int i = 0; i < 3; ++i) {
        const int k = axes[i];
        out[body::x + k] = b[moving::x + i], out[body::v + k] = b[moving::v + i];
        out[body::e + 1 + k] = b[moving::e + 1 + i], out[body::W + k] = b[moving::w + i], out[body::w + k] = w[i];
        for (int j = 0; j < 3; ++j) out[body::A + 3 * k + axes[j]] = b[moving::A + 3 * i + j];
      }
    }
  }
  // What of a row lies in the plane with this normal.
  LOCKSTEP_INLINE static void keep_in_plane(int normal, const Array& K) {
    if constexpr (G::kFlat) normal = 2;  // in the order of its axes
    for (int i = 0; i < 3; ++i) K[i == normal ? i : 3 + i] = T{};
  }
  // The Jacobians in world axes, and J M^-1 J' of each row.
  LOCKSTEP_INLINE void read_jacobians() const {
    const std::array<int, 3> axes = tree.plan.axes();
    for (std::size_t j = 0; j < plan.n_rows(); ++j) {
      T diagonal{};
      for_sides(
          j, [&](std::size_t at, const ClosureSlot& s) __attribute__((always_inline)) {
            const Array inverse = c.inverse + 7 * s.node, K = c.J + 6 * at;
            for (int i = 0; i < 6; ++i) K[i] = c.rows.J[s.J + s.m * (3 * (i / 3) + axes[i % 3])];
            const auto f = G::linear(K, 0);
            const W t = G::axial(K, 3);
            diagonal += inverse[0] * dot(f, f);
            if constexpr (G::kFlat)
              diagonal += inverse[6] * dot(t, t);
            else
              diagonal += dot(t, load_symmetric(inverse, 1) * t);
            store3(K, 3, to<W>(G::matrix(tree.moving_at(static_cast<std::ptrdiff_t>(s.node)), moving::A) * t));
            if (plan.normal >= 0) keep_in_plane(plan.normal, K);
          });
      c.diagonal[j] = diagonal;
    }
  }
  LOCKSTEP_INLINE void measure_scales() const {
    for (const ClosureLink& link : plan.links) {
      T s[kMaxRows];
      for (int k = 0; k < link.m; ++k) s[k] = c.diagonal[link.first_row + k];
      average_scales(s, link.m, link.kinds);
      for (int k = 0; k < link.m; ++k) c.scale[link.first_row + k] = s[k];
    }
  }
  // Scales s_j, and all rows at the nodes of their slots.
  LOCKSTEP_INLINE Rows begin() const {
    if constexpr (!bodies::kUncompared<T>) measure_scales();
    Rows rows{plan.fronts, c.K, c.l, c.Lambda, c.V, c.scale, c.d, c.lambda, {}, {}, nullptr, nullptr};
    rows.clear();
    for (std::size_t j = 0; j < plan.n_rows(); ++j) {
      rows.l_of(j) = -c.rows.c[j];
      for_sides(
          j, [&](std::size_t at, const ClosureSlot&)
                 __attribute__((always_inline)) { rows.K[plan.fronts.sides[at].place] += J_of(at); });
    }
    return rows;
  }
};

}  // namespace lockstep::numbers
