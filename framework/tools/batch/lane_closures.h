// Rows that close loops, in lanes: eliminated along with the recursion (dynamics/tree/open_rows.h) on packs, in space.
// Private to the room.
#pragma once

#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/dynamics/tree/open_rows.h"
#include "framework/tools/batch/closure_plan.h"
#include "framework/tools/batch/lane_rows.h"
#include "framework/tools/batch/lane_tree.h"

namespace lockstep::lanes::LOCKSTEP_SET {

using Wrench = Space::Wrench;
using Twist = Space::Twist;
static_assert(sizeof(Wrench) == spatial::size * sizeof(V) && sizeof(Twist) == spatial::size * sizeof(V));
LOCKSTEP_LANE Wrench load_wrench(const double* p, std::size_t at) {
  return {load3(p, spatial::size * at), load3(p, spatial::size * at + 3)};
}
LOCKSTEP_LANE std::size_t as_size(int n) { return static_cast<std::size_t>(n); }

// ------------------------------------------------------------------------------------------------------------ rows

/// The motions of the slots that rows touch, for lane_rows.h.
LOCKSTEP_LANE void show_bodies(const ClosurePlan& plan, const TreeNumbers& z, const ClosureNumbers& c) {
  for (const ClosurePlan::Seen& s : plan.seen) {
    const double* b = pack(z.moving, moving::size * (s.node + 1));
    double* to = pack(c.rows.body, body::size * s.slot);
    const M3 A = load9(b, moving::A);
    const V3 w = load3(b, moving::w);
    store3(to, body::x, load3(b, moving::x)), store3(to, body::v, load3(b, moving::v));
    store3(to, body::A, A.r0), store3(to, body::A + 3, A.r1), store3(to, body::A + 6, A.r2);
    store4(to, body::e, load4(b, moving::e));
    store3(to, body::w, transpose_times(A, w)), store3(to, body::W, w);
  }
}

/// What of a row lies in the plane with this normal.
LOCKSTEP_LANE void keep_in_plane(int normal, Wrench& J) {
  const V zero{};
  (normal == 0 ? J.f.x : normal == 1 ? J.f.y : J.f.z) = zero;
  if (normal != 0) J.t.x = zero;
  if (normal != 1) J.t.y = zero;
  if (normal != 2) J.t.z = zero;
}

/// The jacobians in world axes, and J M^-1 J' of each row.
LOCKSTEP_LANE void read_jacobians(const ClosurePlan& plan, const TreeNumbers& z, const ClosureNumbers& c) {
  for (std::size_t j = 0; j < plan.n_rows(); ++j) {
    const ClosureSource& source = plan.fronts.sources[j];
    V diagonal{};
    for (int i = 0; i < source.n_sides; ++i) {
      const std::size_t at = as_size(source.first_side + i);
      const ClosureSlot& s = plan.slots[at];
      const double *J = pack(c.rows.J, s.J), *inverse = pack(c.inverse, 7 * s.node);
      const V3 t{load(J, 3 * s.m), load(J, 4 * s.m), load(J, 5 * s.m)};
      Wrench K{{load(J, 0), load(J, s.m), load(J, 2 * s.m)},
               load9(pack(z.moving, moving::size * (s.node + 1)), moving::A) * t};
      if (plan.normal >= 0) keep_in_plane(plan.normal, K);
      diagonal += load(inverse, 0) * dot(K.f, K.f) + dot(t, load_symmetric(inverse, 1) * t);
      store3(c.J, spatial::size * at, K.f), store3(c.J, spatial::size * at + 3, K.t);
    }
    store(c.diagonal, j, diagonal);
  }
}

/// C's rate: J v + Ct.
LOCKSTEP_LANE void closure_rates(const ClosurePlan& plan, const TreeNumbers& z, const ClosureNumbers& c) {
  for (std::size_t j = 0; j < plan.n_rows(); ++j) {
    const ClosureSource& source = plan.fronts.sources[j];
    V Cd = load(c.rows.Ct, j);
    for (int i = 0; i < source.n_sides; ++i) {
      const std::size_t at = as_size(source.first_side + i);
      const double* b = pack(z.moving, moving::size * (plan.slots[at].node + 1));
      Cd += dot(load_wrench(c.J, at), Twist{load3(b, moving::v), load3(b, moving::w)});
    }
    store(c.Cd, j, Cd);
  }
}

LOCKSTEP_LANE void closure_rows(const ClosurePlan& plan, const TreeNumbers& z, const ClosureNumbers& c) {
  show_bodies(plan, z, c);
  for (const Link& link : plan.rows.links) rows<false, For::acceleration>(plan.rows, link, c.rows);
  read_jacobians(plan, z, c);
}
LOCKSTEP_LANE void closure_errors(const ClosurePlan& plan, const TreeNumbers& z, const ClosureNumbers& c) {
  show_bodies(plan, z, c);
  for (const Link& link : plan.rows.links) rows<false, For::projection>(plan.rows, link, c.rows);
  read_jacobians(plan, z, c);
  closure_rates(plan, z, c);
}

using LaneRows = OpenRows<Space, LaneArray>;
LOCKSTEP_LANE LaneRows open_rows(const ClosurePlan& plan, const ClosureNumbers& c) {
  return {plan.fronts,
          reinterpret_cast<Wrench*>(c.K),
          {c.l},
          {c.Lambda},
          {c.V},
          {c.scale},
          {c.d},
          {c.lambda},
          {c.dlambda},
          {c.du},
          reinterpret_cast<Wrench*>(c.wrench),
          reinterpret_cast<Twist*>(c.change)};
}

/// Scales s_j, and all rows at the nodes of their slots.
LOCKSTEP_LANE void begin_elimination(const ClosurePlan& plan, const ClosureNumbers& c, LaneRows& rows) {
  for (const ClosureLink& link : plan.links) {
    V s[kMaxRows];
    for (int k = 0; k < link.m; ++k) s[k] = load(c.diagonal, link.first_row + as_size(k));
    average_scales(s, link.m, link.kinds);
    for (int k = 0; k < link.m; ++k) store(c.scale, link.first_row + as_size(k), s[k]);
  }
  rows.clear();
  for (std::size_t j = 0; j < plan.n_rows(); ++j) {
    const ClosureSource& source = plan.fronts.sources[j];
    rows.l_of(j) = -load(c.rows.c, j);
    for (int i = 0; i < source.n_sides; ++i) {
      const std::size_t at = as_size(source.first_side + i);
      rows.K[plan.fronts.sides[at].place] += load_wrench(c.J, at);
    }
  }
}

LOCKSTEP_LANE void accelerate_closed(const TreePlan& tree, const TreeNumbers& z, const ClosurePlan& plan,
                                     const ClosureNumbers& c, double* rate) {
  LaneRows rows = open_rows(plan, c);
  closure_rows(plan, z, c);
  begin_elimination(plan, c, rows);
  inward(tree, z, rows);
  solve(tree, z, rate, rows);
  kinematic_rates(tree, z, rate);
}
LOCKSTEP_LANE void factor_closures(const TreePlan& tree, const TreeNumbers& z, const ClosurePlan& plan,
                                   const ClosureNumbers& c) {
  LaneRows rows = open_rows(plan, c);
  begin_elimination(plan, c, rows);
  inward(tree, z, rows);
}
LOCKSTEP_LANE void correct_closures(const TreePlan& tree, const TreeNumbers& z, const ClosurePlan& plan,
                                    const ClosureNumbers& c, const double* r, double* dv) {
  const LaneSlots slots{tree, z};
  open_rows(plan, c).correct(slots, reads(r, 0), LaneArray{dv});
}
/// To the accelerations: what the last correction changes, whose dv this is.
LOCKSTEP_LANE void add_correction(const TreePlan& tree, const TreeNumbers& z, const ClosurePlan& plan,
                                  const ClosureNumbers& c, const double* dv, double* rate) {
  for (std::size_t i = 0; i < tree.n_v; ++i) store(rate, tree.n_q + i, load(rate, tree.n_q + i) + load(dv, i));
  for (std::size_t j = 0; j < plan.n_rows(); ++j) store(c.lambda, j, load(c.lambda, j) + load(c.dlambda, j));
  const LaneSlots slots{tree, z};
  add_changes(slots, reinterpret_cast<const Twist*>(c.change)).put(z.largest);
}

// ------------------------------------------------------------------------------------------------------- the rule

/// r = J a - c, and the largest |r| relative to its scale, as ClosureRows has it: of all rows, and of those that are not
/// redundant. `raised`: scales are at least what the accelerations of the slots could give in any frame.
LOCKSTEP_LANE void closure_residuals(const ClosurePlan& plan, const TreeNumbers& z, const ClosureNumbers& c,
                                     bool raised, double* out) {
  V largest[3] = {V{}, V{}, V{}};
  for (std::size_t j = 0; j < plan.n_rows(); ++j) {
    const ClosureSource& source = plan.fronts.sources[j];
    V r, size;
    const auto side = [&](std::size_t at, auto&& take) __attribute__((always_inline)) {
      take(load_wrench(c.J, at), found_at(z, plan.slots[at].node));
    };
    measure_row(source, raised, load(c.rows.c, j), r, size, side);
    size = larger(size, kScaleFloor * load(c.scale, j) * magnitude(load(c.lambda, j)));
    V& most = largest[static_cast<std::size_t>(source.kind)];
    most = larger(most, size);
    store(c.r, j, r), store(c.size, j, size);
  }
  V worst{}, regular{};
  for (std::size_t j = 0; j < plan.n_rows(); ++j) {
    const V r = load(c.r, j), most = largest[static_cast<std::size_t>(plan.fronts.sources[j].kind)];
    const V scale = larger(load(c.size, j), kScaleFloor * most);
    const V x = r == 0.0 ? V{} : magnitude(r) / scale;
    const V of_regular = load(c.d, j) <= kRedundantPivot * kClosureProximal * load(c.scale, j) ? V{} : x;
    worst = largest_or_nan(worst, x), regular = largest_or_nan(regular, of_regular);
  }
  store(out, 0, worst), store(out, 1, regular);
}

/// Of the pivots: how many are small, and the smallest of the others, as `pivots`.
LOCKSTEP_LANE void closure_pivots(const ClosurePlan& plan, const ClosureNumbers& c, const double* left, double* out) {
  V n_small{}, smallest = V{} + 1.0;
  for (std::size_t j = 0; j < plan.n_rows(); ++j) {
    const V pivot = load(c.d, j), diagonal = load(c.diagonal, j);
    const V small = what_counts_as_small(diagonal, load(left, static_cast<std::size_t>(plan.fronts.sources[j].kind)));
    const V relative = pivot < small ? V{} + 1.0 : pivot / diagonal;
    n_small += pivot < small ? V{} + 1.0 : V{};
    smallest = relative < smallest ? relative : smallest;
  }
  store(out, 0, n_small), store(out, 1, smallest);
}

/// The norm of Dynamics::norm: metres; L: a pack.
LOCKSTEP_LANE void closure_norm(const ClosurePlan& plan, const double* x, const double* L, double* out) {
  V t{}, r{};
  for (std::size_t j = 0; j < plan.n_rows(); ++j) {
    V& most = plan.fronts.sources[j].kind == RowKind::translation ? t : r;
    const V size = magnitude(load(x, j));
    most = largest_or_nan(most, size);
  }
  const V turned = 2.0 * load(L, 0) * r;
  store(out, 0, largest_or_nan(t, turned));
}

/// The arrays, beginning at this lane: K, wrench and change at those of its round.
LOCKSTEP_LANE ClosureNumbers from(const ClosurePlan& plan, const ClosureNumbers& c, int lane) {
  ClosureNumbers n = c;
  for (const double** p : {&n.inverse, &n.rows.frames, &n.rows.law}) *p += lane;
  for (double** p : {&n.rows.body, &n.rows.J, &n.rows.c, &n.rows.C, &n.rows.Ct}) *p += lane;
  for (double** p :
       {&n.J, &n.l, &n.Lambda, &n.V, &n.diagonal, &n.scale, &n.d, &n.lambda, &n.dlambda, &n.r, &n.size, &n.Cd, &n.du})
    *p += lane;
  const std::size_t l = spatial::size * as_size(lane);
  n.K += l * plan.fronts.rows.size(), n.wrench += l * plan.fronts.n_nodes, n.change += l * plan.fronts.n_nodes;
  return n;
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
