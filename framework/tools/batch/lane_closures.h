// Rows that close loops, eliminated along with the recursion, in lanes: dynamics/tree/loop_closures.h on packs, in space.
// Private to the room.
//
// A row j is  K a + l - Lambda lambda - E lambda = 0. Past one coordinate of a joint, with S, U, D, u of the recursion:
//
//     kappa = K S,   V = kappa / D,   K <- K - V U',   l <- l + V u,   Lambda <- Lambda + kappa V'
//
// then l <- l + K c, and K about the parent's mass centre. Where it ends, d = Lambda_jj, with E where that is small.
#pragma once

#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/tools/batch/closure_plan.h"
#include "framework/tools/batch/lane_rows.h"
#include "framework/tools/batch/lane_tree.h"

namespace lockstep::lanes::LOCKSTEP_SET {

/// A force and a moment; or an acceleration and an angular one.
struct LaneWrench {
  V3 f, t;
};
LOCKSTEP_LANE LaneWrench load_wrench(const double* p, std::size_t place) {
  return {load3(p, spatial::size * place), load3(p, spatial::size * place + 3)};
}
LOCKSTEP_LANE void store_wrench(double* p, std::size_t place, const LaneWrench& K) {
  store3(p, spatial::size * place, K.f), store3(p, spatial::size * place + 3, K.t);
}
LOCKSTEP_LANE V times(const LaneWrench& K, const V3& a, const V3& al) { return dot(K.f, a) + dot(K.t, al); }
LOCKSTEP_LANE LaneWrench sum(const LaneWrench& a, const LaneWrench& b) { return {a.f + b.f, a.t + b.t}; }
LOCKSTEP_LANE LaneWrench scaled(const V& x, const LaneWrench& a) { return {x * a.f, x * a.t}; }
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
LOCKSTEP_LANE void keep_in_plane(int normal, LaneWrench& J) {
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
      LaneWrench K{{load(J, 0), load(J, s.m), load(J, 2 * s.m)},
                   load9(pack(z.moving, moving::size * (s.node + 1)), moving::A) * t};
      if (plan.normal >= 0) keep_in_plane(plan.normal, K);
      diagonal += load(inverse, 0) * dot(K.f, K.f) + dot(t, load_symmetric(inverse, 1) * t);
      store_wrench(c.J, at, K);
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
      Cd += times(load_wrench(c.J, at), load3(b, moving::v), load3(b, moving::w));
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

/// Scales s_j and proximal terms, and all rows at the nodes of their slots.
LOCKSTEP_LANE void begin_elimination(const ClosurePlan& plan, const ClosureNumbers& c) {
  for (const ClosureLink& link : plan.links) {
    V s[kMaxRows];
    for (int k = 0; k < link.m; ++k) s[k] = load(c.diagonal, link.first_row + as_size(k));
    average_scales(s, link.m, link.kinds);
    for (int k = 0; k < link.m; ++k) {
      const std::size_t row = link.first_row + as_size(k);
      store(c.scale, row, s[k]), store(c.E, row, kClosureProximal * s[k]);
    }
  }
  const V zero{};
  for (std::size_t i = 0; i < spatial::size * plan.fronts.rows.size(); ++i) store(c.K, i, zero);
  for (std::size_t i = 0; i < plan.fronts.rows.size(); ++i) store(c.l, i, zero);
  for (std::size_t i = 0; i < as_size(plan.fronts.n_Lambda); ++i) store(c.Lambda, i, zero);
  for (std::size_t j = 0; j < plan.n_rows(); ++j) {
    const ClosureSource& source = plan.fronts.sources[j];
    store(c.l, plan.slots[as_size(source.first_side)].place, -load(c.rows.c, j));
    for (int i = 0; i < source.n_sides; ++i) {
      const std::size_t at = as_size(source.first_side + i);
      store_wrench(c.K, plan.slots[at].place, load_wrench(c.J, at));
    }
  }
}

// ----------------------------------------------------------------------------------------------------- elimination

/// The open rows on their way, as LoopClosures has them.
struct OpenRows {
  const ClosurePlan& plan;
  const ClosureNumbers& c;
  static constexpr bool kAny = true;

  LOCKSTEP_LANE std::size_t row_of(const ClosureFront& f, int i) const { return as_size(plan.fronts.row_of(f, i)); }
  LOCKSTEP_LANE double* Lambda(const ClosureFront& f, int i) const {
    return pack(c.Lambda, as_size(f.Lambda + i * f.n));
  }
  LOCKSTEP_LANE double* V_of(const ClosureFront& f, int i, int n_v) const { return pack(c.V, as_size(f.V + i * n_v)); }

  /// Row j of a front, which ends there, changes those before it; returns 1 / d.
  LOCKSTEP_LANE V eliminate(const ClosureFront& front, int j, bool at_ground) const {
    const std::size_t row = row_of(front, j), last = as_size(front.first + j);
    const double* at = Lambda(front, j);
    const V pivot = load(at, as_size(j)), least = kSmallPivot * load(c.scale, row);
    const V d = pivot < least ? larger(pivot, V{}) + load(c.E, row) : pivot, d_1 = 1.0 / d;
    store(c.d, row, d);
    const V l = load(c.l, last);
    const LaneWrench K = load_wrench(c.K, last);
    for (int i = 0; i < j; ++i) {
      const std::size_t place = as_size(front.first + i);
      const V x = load(at, as_size(i)) * d_1;
      if (!at_ground) store_wrench(c.K, place, sum(load_wrench(c.K, place), scaled(-x, K)));
      store(c.l, place, load(c.l, place) - x * l);
      double* to = Lambda(front, i);
      for (int k = 0; k <= i; ++k) store(to, as_size(k), load(to, as_size(k)) - x * load(at, as_size(k)));
    }
    return d_1;
  }
  LOCKSTEP_LANE void close(std::size_t k, LaneInertia& IA) const {
    const ClosureFront& front = plan.fronts.all[k];
    for (int j = front.n - 1; j >= front.n_open; --j) {
      const V d_1 = eliminate(front, j, false);
      const std::size_t place = as_size(front.first + j);
      const LaneWrench K = load_wrench(c.K, place);
      IA.reduce(K.f, K.t, -load(c.l, place), -d_1);  // IA <- IA + K' K / d, p <- p + K' l / d
    }
  }
  /// Adds the open rows of a front to those of its parent.
  LOCKSTEP_LANE void add_to_parent(std::size_t k) const {
    const ClosureFront &front = plan.fronts.all[k], &up = plan.fronts.all[plan.fronts.parents[k]];
    const int* above = plan.fronts.above.data() + front.first;
    for (int i = 0; i < front.n_open; ++i) {
      const std::size_t place = as_size(front.first + i), there = as_size(up.first + above[i]);
      store_wrench(c.K, there, sum(load_wrench(c.K, there), load_wrench(c.K, place)));
      store(c.l, there, load(c.l, there) + load(c.l, place));
      const double* from = Lambda(front, i);
      double* to = Lambda(up, above[i]);
      for (int j = 0; j <= i; ++j) {
        const std::size_t at = as_size(above[j]);
        store(to, at, load(to, at) + load(from, as_size(j)));
      }
    }
  }
  /// Past the joint of a node, after its coordinates are eliminated.
  LOCKSTEP_LANE void pass_on(const LaneNode& n, const TreeNumbers& z, std::size_t k) const {
    const ClosureFront& front = plan.fronts.all[k];
    if (front.n_open == 0) return;
    const double *b = pack(z.moving, moving::size * (k + 1)), *dofs = pack(z.dof, dof::size * n.v);
    const V3 ca = load3(b, moving::ca), cal = load3(b, moving::cal), r = load3(b, moving::r);
    const int n_v = n.n_v();
    for (int i = 0; i < front.n_open; ++i) {
      const std::size_t place = as_size(front.first + i);
      LaneWrench K = load_wrench(c.K, place);
      V l = load(c.l, place), kappa[6];
      for (int x = 0; x < n_v; ++x) {
        const double* d = pack(dofs, dof::size * as_size(x));
        kappa[x] = times(K, load3(d, dof::l), load3(d, dof::n));
        const V v = kappa[x] * load(d, dof::D_1);
        store(V_of(front, i, n_v), as_size(x), v);
        K = {K.f - v * load3(d, dof::Uf), K.t - v * load3(d, dof::Ut)};
        l += v * load(d, dof::u);
      }
      l += times(K, ca, cal);
      K.t = K.t + cross(r, K.f);
      store_wrench(c.K, place, K), store(c.l, place, l);
      for (int j = 0; j <= i; ++j) {
        V sum = load(Lambda(front, i), as_size(j));
        for (int x = 0; x < n_v; ++x) sum += kappa[x] * load(V_of(front, j, n_v), as_size(x));
        store(Lambda(front, i), as_size(j), sum);
      }
    }
    add_to_parent(k);
  }
  LOCKSTEP_LANE void close_at_ground() const {
    for (std::size_t k = plan.fronts.n_nodes; k < plan.fronts.all.size(); ++k) {
      const ClosureFront& front = plan.fronts.all[k];
      for (int j = front.n - 1; j >= front.n_open; --j) eliminate(front, j, true);
      if (front.n_open > 0) add_to_parent(k);
    }
    find_at_ground(c.lambda);
  }
  LOCKSTEP_LANE void find_at_ground(double* lambda) const {
    for (std::size_t k = plan.fronts.all.size(); k-- > plan.fronts.n_nodes;) find(k, zero3(), zero3(), lambda);
  }
  /// V' lambda of a coordinate.
  LOCKSTEP_LANE V less(std::size_t k, int n_v, int x, const double* lambda) const {
    const ClosureFront& front = plan.fronts.all[k];
    V sum{};
    for (int i = 0; i < front.n_open; ++i)
      sum += load(V_of(front, i, n_v), as_size(x)) * load(lambda, row_of(front, i));
    return sum;
  }
  LOCKSTEP_LANE V less(std::size_t k, int n_v, int x) const { return less(k, n_v, x, c.lambda); }
  /// lambda_j = (K_j a + l_j - sum of Lambda_ij lambda_i) / d of the rows that end at a node.
  LOCKSTEP_LANE void find(std::size_t k, const V3& a, const V3& al, double* lambda) const {
    const ClosureFront& front = plan.fronts.all[k];
    for (int j = front.n_open; j < front.n; ++j) {
      const std::size_t place = as_size(front.first + j), row = row_of(front, j);
      V sum = load(c.l, place) + times(load_wrench(c.K, place), a, al);
      for (int i = 0; i < j; ++i) sum -= load(Lambda(front, j), as_size(i)) * load(lambda, row_of(front, i));
      store(lambda, row, sum / load(c.d, row));
    }
  }
  LOCKSTEP_LANE void find(std::size_t k, const V3& a, const V3& al) const { find(k, a, al, c.lambda); }
};

// ----------------------------------------------------------------------------------------------------- corrections

/// The elimination again, for p = 0, c = 0 and l = r: J (change) = -r.
struct Correction {
  const TreePlan& tree;
  const TreeNumbers& z;
  OpenRows rows;

  LOCKSTEP_LANE const ClosureFronts& fronts() const { return rows.plan.fronts; }
  LOCKSTEP_LANE const ClosureNumbers& c() const { return rows.c; }

  LOCKSTEP_LANE void close(const ClosureFront& front, LaneWrench& p) const {
    for (int j = front.n - 1; j >= front.n_open; --j) {
      const std::size_t place = as_size(front.first + j);
      const V x = load(c().l, place) / load(c().d, rows.row_of(front, j));
      p = sum(p, scaled(x, load_wrench(c().K, place)));
      for (int i = 0; i < j; ++i) {
        const std::size_t before = as_size(front.first + i);
        store(c().l, before, load(c().l, before) - load(rows.Lambda(front, j), as_size(i)) * x);
      }
    }
  }
  LOCKSTEP_LANE void add_above(std::size_t k, int i, const V& l) const {
    const std::size_t there = as_size(fronts().place_above(k, i));
    store(c().l, there, load(c().l, there) + l);
  }
  LOCKSTEP_LANE void inward_at(std::size_t k) const {
    const ClosureFront& front = fronts().all[k];
    const LaneNode& n = tree.nodes[k];
    double* u = pack(c().du, n.v);
    LaneWrench p = load_wrench(c().wrench, k);
    close(front, p);
    for (int x = 0; x < n.n_v(); ++x) {
      const double* d = pack(z.dof, dof::size * (n.v + as_size(x)));
      const V by = -times(p, load3(d, dof::l), load3(d, dof::n)), y = load(d, dof::D_1) * by;
      store(u, as_size(x), by);
      p = {p.f + y * load3(d, dof::Uf), p.t + y * load3(d, dof::Ut)};
    }
    for (int i = 0; i < front.n_open; ++i) {
      V l = load(c().l, as_size(front.first + i));
      for (int x = 0; x < n.n_v(); ++x) l += load(rows.V_of(front, i, n.n_v()), as_size(x)) * load(u, as_size(x));
      add_above(k, i, l);
    }
    if (n.parent < 0) return;
    p.t = p.t + cross(load3(pack(z.moving, moving::size * (k + 1)), moving::r), p.f);
    const std::size_t parent = as_size(n.parent);
    store_wrench(c().wrench, parent, sum(load_wrench(c().wrench, parent), p));
  }
  LOCKSTEP_LANE void inward(const double* r) const {
    const V zero{};
    for (std::size_t i = 0; i < fronts().rows.size(); ++i) store(c().l, i, zero);
    for (std::size_t i = 0; i < spatial::size * tree.nodes.size(); ++i) store(c().wrench, i, zero);
    for (std::size_t j = 0; j < rows.plan.n_rows(); ++j)
      store(c().l, rows.plan.slots[as_size(fronts().sources[j].first_side)].place, load(r, j));
    for (std::size_t k = tree.nodes.size(); k-- > 0;) inward_at(k);
    for (std::size_t k = fronts().n_nodes; k < fronts().all.size(); ++k) {
      const ClosureFront& front = fronts().all[k];
      LaneWrench nothing{zero3(), zero3()};
      close(front, nothing);
      for (int i = 0; i < front.n_open; ++i) add_above(k, i, load(c().l, as_size(front.first + i)));
    }
    rows.find_at_ground(c().dlambda);
  }
  LOCKSTEP_LANE void outward(double* dv) const {
    for (std::size_t k = 0; k < tree.nodes.size(); ++k) {
      const LaneNode& n = tree.nodes[k];
      V3 a = zero3(), al = zero3();
      if (n.parent >= 0) {
        const LaneWrench p = load_wrench(c().change, as_size(n.parent));
        al = p.t, a = p.f + cross(al, load3(pack(z.moving, moving::size * (k + 1)), moving::r));
      }
      for (int i = n.n_v(); i-- > 0;) {
        const std::size_t at = n.v + as_size(i);
        const double* d = pack(z.dof, dof::size * at);
        const V left = load(c().du, at) - dot(load3(d, dof::Uf), a) - dot(load3(d, dof::Ut), al);
        const V x = load(d, dof::D_1) * left - rows.less(k, n.n_v(), i, c().dlambda);
        store(dv, at, x);
        a = a + x * load3(d, dof::l), al = al + x * load3(d, dof::n);
      }
      store_wrench(c().change, k, {a, al});
      rows.find(k, a, al, c().dlambda);
    }
  }
};

LOCKSTEP_LANE void accelerate_closed(const TreePlan& tree, const TreeNumbers& z, const ClosurePlan& plan,
                                     const ClosureNumbers& c, double* rate) {
  const OpenRows rows{plan, c};
  closure_rows(plan, z, c);
  begin_elimination(plan, c);
  inward(tree, z, rows);
  rows.close_at_ground();
  solve(tree, z, rate, rows);
  kinematic_rates(tree, z, rate);
}
LOCKSTEP_LANE void factor_closures(const TreePlan& tree, const TreeNumbers& z, const ClosurePlan& plan,
                                   const ClosureNumbers& c) {
  const OpenRows rows{plan, c};
  begin_elimination(plan, c);
  inward(tree, z, rows);
  rows.close_at_ground();
}
LOCKSTEP_LANE void correct_closures(const TreePlan& tree, const TreeNumbers& z, const ClosurePlan& plan,
                                    const ClosureNumbers& c, const double* r, double* dv) {
  const Correction correction{tree, z, {plan, c}};
  correction.inward(r);
  correction.outward(dv);
}
/// To the accelerations: what the last correction changes, whose dv this is.
LOCKSTEP_LANE void add_correction(const TreePlan& tree, const TreeNumbers& z, const ClosurePlan& plan,
                                  const ClosureNumbers& c, const double* dv, double* rate) {
  for (std::size_t i = 0; i < tree.n_v; ++i) store(rate, tree.n_q + i, load(rate, tree.n_q + i) + load(dv, i));
  for (std::size_t j = 0; j < plan.n_rows(); ++j) store(c.lambda, j, load(c.lambda, j) + load(c.dlambda, j));
  V most{}, most_turned{};
  for (std::size_t k = 0; k < tree.nodes.size(); ++k) {
    double* b = pack(z.moving, moving::size * (k + 1));
    const LaneWrench change = load_wrench(c.change, k);
    const V3 a = load3(b, moving::a) + change.f, al = load3(b, moving::al) + change.t;
    store3(b, moving::a, a), store3(b, moving::al, al);
    const V a2 = dot(a, a), al2 = dot(al, al);
    most = largest_or_nan(most, a2), most_turned = largest_or_nan(most_turned, al2);
  }
  store(z.largest, 0, most), store(z.largest, 1, most_turned);
}

// ------------------------------------------------------------------------------------------------------- the rule

/// r = J a - c, and the largest |r| relative to its scale, as ClosureRows has it: of all rows, and of those that are not
/// redundant. `raised`: scales are at least what the accelerations of the slots could give in any frame.
LOCKSTEP_LANE void closure_residuals(const ClosurePlan& plan, const TreeNumbers& z, const ClosureNumbers& c,
                                     bool raised, double* out) {
  V largest[3] = {V{}, V{}, V{}};
  for (std::size_t j = 0; j < plan.n_rows(); ++j) {
    const ClosureSource& source = plan.fronts.sources[j];
    const V Qhat = load(c.rows.c, j);
    V r = -Qhat, size = size_of(Qhat), bound{};
    for (int i = 0; i < source.n_sides; ++i) {
      const std::size_t at = as_size(source.first_side + i);
      const double* b = pack(z.moving, moving::size * (plan.slots[at].node + 1));
      const LaneWrench J = load_wrench(c.J, at);
      const V3 a = load3(b, moving::a), al = load3(b, moving::al);
      const V x = times(J, a, al);
      r += x, size += size_of(x);
      if (raised) bound += square_root(dot(J.f, J.f) * dot(a, a)) + square_root(dot(J.t, J.t) * dot(al, al));
    }
    size = larger(size, kScaleFloor * load(c.scale, j) * size_of(load(c.lambda, j)));
    if (raised) size = larger(size, kScaleFloor * bound);
    V& most = largest[static_cast<std::size_t>(source.kind)];
    most = larger(most, size);
    store(c.r, j, r), store(c.size, j, size);
  }
  V worst{}, regular{};
  for (std::size_t j = 0; j < plan.n_rows(); ++j) {
    const V r = load(c.r, j), most = largest[static_cast<std::size_t>(plan.fronts.sources[j].kind)];
    const V scale = larger(load(c.size, j), kScaleFloor * most);
    const V x = r == 0.0 ? V{} : size_of(r) / scale;
    const V of_regular = load(c.d, j) <= kRedundantPivot * load(c.E, j) ? V{} : x;
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
    const V size = size_of(load(x, j));
    most = largest_or_nan(most, size);
  }
  const V turned = 2.0 * load(L, 0) * r;
  store(out, 0, largest_or_nan(t, turned));
}

/// The arrays, beginning at this lane.
LOCKSTEP_LANE ClosureNumbers from(const ClosureNumbers& c, int lane) {
  ClosureNumbers n = c;
  for (const double** p : {&n.inverse, &n.rows.frames, &n.rows.law}) *p += lane;
  for (double** p : {&n.rows.body, &n.rows.J, &n.rows.c, &n.rows.C, &n.rows.Ct}) *p += lane;
  for (double** p : {&n.J, &n.K, &n.l, &n.Lambda, &n.V, &n.E, &n.diagonal, &n.scale, &n.d, &n.lambda, &n.dlambda, &n.r,
                     &n.size, &n.Cd, &n.wrench, &n.change, &n.du})
    *p += lane;
  return n;
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
