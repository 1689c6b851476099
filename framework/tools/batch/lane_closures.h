// SPDX-License-Identifier: BSD-3-Clause
// LaneClosures: rows that close loops, eliminated along with the recursion (dynamics/tree/open_rows.h) on arrays of any
// numbers. Private to the room.
#pragma once

#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/dynamics/tree/open_rows.h"
#include "framework/tools/batch/closure_plan.h"
#include "framework/tools/batch/lane_rows.h"
#include "framework/tools/batch/lane_tree.h"

namespace lockstep::lanes {

template <class G>
struct LaneClosures {
  using Tree = LaneTree<G>;
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

  template <For kFor>
  LOCKSTEP_LANE void gather() const {
    show_bodies();
    for (const Link& link : plan.masks) LinkRows<kFor, Array>(link, c.rows).write();
    read_jacobians();
  }
  /// Those of the projection: J, C, Cd.
  LOCKSTEP_LANE void errors() const { gather<For::projection>(), rates(); }
  /// C's rate: J v + Ct.
  LOCKSTEP_LANE void rates() const {
    for (std::size_t j = 0; j < plan.n_rows(); ++j) {
      T Cd = c.rows.Ct[j];
      for_sides(
          j, [&](std::size_t at, const ClosureSlot& s) __attribute__((always_inline)) {
            const Array b = tree.moving_at(static_cast<std::ptrdiff_t>(s.node));
            const Twist of{Space::from(G::linear(b, moving::v)), Space::from_axial(G::axial(b, moving::w))};
            Cd += dot(J_of(at), of);
          });
      c.Cd[j] = Cd;
    }
  }

  // ----------------------------------------------------------------------------------------------------- elimination

  LOCKSTEP_LANE void accelerate(const Array& rate) const {
    gather<For::acceleration>();
    Rows rows = begin();
    tree.accelerate(rate, rows);
  }
  /// The elimination alone, of the Jacobians as found last.
  LOCKSTEP_LANE void factor() const {
    Rows rows = begin();
    tree.inward(rows);
  }
  /// The change dv of the velocities, and of the slots', by which residuals r vanish, by the last elimination.
  LOCKSTEP_LANE void correct(const Array& r, const Array& dv) const { open_rows().correct(tree, r, dv); }
  /// To the accelerations: what the last correction changes, whose dv this is.
  LOCKSTEP_LANE void add_correction(const Array& dv, const Array& rate) const {
    for (std::size_t i = 0; i < tree.plan.n_v; ++i) rate[tree.plan.n_q + i] += dv[i];
    for (std::size_t j = 0; j < plan.n_rows(); ++j) c.lambda[j] += c.dlambda[j];
    add_changes(tree, c.change).put(tree.z.largest);
  }

  // -------------------------------------------------------------------------------------------------------- the rule

  /// r = J a - c, and the largest |r| relative to its scale, as ClosureRows has it: of all rows, and of those that are not
  /// redundant. `raised`: scales are at least what the accelerations of the slots could give in any frame.
  LOCKSTEP_LANE void residuals(bool raised, const Array& out) const {
    T largest[3] = {T{}, T{}, T{}};
    for (std::size_t j = 0; j < plan.n_rows(); ++j) {
      const ClosureSource& source = plan.fronts.sources[j];
      T r, size;
      const auto side = [&](std::size_t at, auto&& take) __attribute__((always_inline)) {
        take(J_of(at), tree.found(plan.slots[at].node));
      };
      measure_row(source, raised, c.rows.c[j], r, size, side);
      const T of_lambda = kScaleFloor * c.scale[j] * bodies::magnitude(c.lambda[j]);
      size = larger(size, of_lambda);
      T& most = largest[static_cast<std::size_t>(source.kind)];
      most = larger(most, size);
      c.r[j] = r, c.size[j] = size;
    }
    T worst{}, regular{};
    for (std::size_t j = 0; j < plan.n_rows(); ++j) {
      const T r = c.r[j], least = kScaleFloor * largest[static_cast<std::size_t>(plan.fronts.sources[j].kind)];
      const T x = r == 0.0 ? T{} : bodies::magnitude(r) / larger<T>(c.size[j], least);
      const T of_regular = c.d[j] <= kRedundantPivot * kClosureProximal * c.scale[j] ? T{} : x;
      worst = largest_or_nan(worst, x), regular = largest_or_nan(regular, of_regular);
    }
    out[0] = worst, out[1] = regular;
  }

 private:
  template <class F>
  LOCKSTEP_LANE void for_sides(std::size_t row, F&& f) const {
    const ClosureSource& source = plan.fronts.sources[row];
    for (int i = 0; i < source.n_sides; ++i) {
      const auto at = static_cast<std::size_t>(source.first_side + i);
      f(at, plan.slots[at]);
    }
  }
  LOCKSTEP_LANE Wrench J_of(std::size_t side) const {
    const Array J = c.J + struct_size::wrench * side;
    return {Space::from(G::linear(J, 0)), Space::from_axial(G::axial(J, 3))};
  }
  // The motions of the slots that rows touch, for LinkRows: in the axes of space.
  LOCKSTEP_LANE void show_bodies() const {
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
  LOCKSTEP_LANE static void keep_in_plane(int normal, const Array& K) {
    if constexpr (G::kFlat) normal = 2;  // in the order of its axes
    for (int i = 0; i < 3; ++i) K[i == normal ? i : 3 + i] = T{};
  }
  // The Jacobians in world axes, and J M^-1 J' of each row.
  LOCKSTEP_LANE void read_jacobians() const {
    const std::array<int, 3> axes = tree.plan.axes();
    for (std::size_t j = 0; j < plan.n_rows(); ++j) {
      T diagonal{};
      for_sides(
          j, [&](std::size_t at, const ClosureSlot& s) __attribute__((always_inline)) {
            const Array inverse = c.inverse + 7 * s.node, K = c.J + struct_size::wrench * at;
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
  LOCKSTEP_LANE Rows open_rows() const {
    return {plan.fronts, c.K, c.l, c.Lambda, c.V, c.scale, c.d, c.lambda, c.dlambda, c.du, c.wrench, c.change};
  }
  LOCKSTEP_LANE void measure_scales() const {
    for (const ClosureLink& link : plan.links) {
      T s[kMaxRows];
      for (int k = 0; k < link.m; ++k) s[k] = c.diagonal[link.first_row + k];
      average_scales(s, link.m, link.kinds);
      for (int k = 0; k < link.m; ++k) c.scale[link.first_row + k] = s[k];
    }
  }
  // Scales s_j, and all rows at the nodes of their slots.
  LOCKSTEP_LANE Rows begin() const {
    if constexpr (!bodies::kUncompared<T>) measure_scales();
    Rows rows = open_rows();
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

}  // namespace lockstep::lanes
