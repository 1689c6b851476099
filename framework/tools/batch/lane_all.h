// All passes for one instruction set: included once by lane_avx512.cpp, lane_fma.cpp and lane_plain.cpp, which define
// LOCKSTEP_SET, LOCKSTEP_WIDE and LOCKSTEP_TARGET. Private to the room.
#pragma once

#include <cmath>

#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/foundation/math/sin_cos.h"
#include "framework/tools/batch/lane_blocks.h"
#include "framework/tools/batch/lane_closures.h"
#include "framework/tools/batch/lane_math.h"
#include "framework/tools/batch/lane_passes.h"
#include "framework/tools/batch/lane_rows.h"
#include "framework/tools/batch/lane_tree.h"

namespace lockstep::lanes::LOCKSTEP_SET {

LOCKSTEP_LANE void see_bodies(const Plan& plan, const Numbers& z) {
  for (int k = 0; k < plan.n_slots; ++k) {
    const LaneArray q = LaneArray(z.y) + 7 * k, v = LaneArray(z.y) + (plan.v_at() + 6 * k);
    const LaneArray b = LaneArray(z.body) + body::size * k;
    Q4 e = load4(q, 3);
    const V s = 1.0 / bodies::square_root(e.w * e.w + dot(e.v, e.v));
    e.w = s * e.w, e.v = s * e.v;
    const M3 A = rotation(e);
    const V3 w = load3(v, 3);
    store3(b, body::x, load3(q, 0)), store9(b, body::A, A), store4(b, body::e, e);
    store3(b, body::v, load3(v, 0));
    store3(b, body::w, w);
    store3(b, body::W, A * w);
  }
}

using K = LaneBlocks;
using X = schur::Spatial;

// (2.8): f = m g + F | -w x J w + T
LOCKSTEP_LANE void free_motion(const Plan& plan, const Numbers& z) {
  const V3 g = load3(LaneArray(z.gravity), 0);
  for (int k = 0; k < plan.n_slots; ++k) {
    const double *M = K::at(z.mass, X::mass * k), *I = K::at(z.inverse, X::mass * k);
    const V3 w = load3(LaneArray(z.body) + body::size * k, body::w);
    const V wk[3] = {w.x, w.y, w.z};
    V Jw[3], al[3];
    schur::inertia_times<K, X>(M, wk, Jw);
    V3 t = cross(V3{Jw[0], Jw[1], Jw[2]}, w), a = g;
    if (z.wrench) {
      const LaneArray F = LaneArray(z.wrench) + 6 * k;
      a = a + K::number(I, 0) * load3(F, 0);
      t = t + load3(F, 3);
    }
    const V tk[3] = {t.x, t.y, t.z};
    schur::inertia_times<K, X>(I, tk, al);
    for (const LaneArray out : {z.af, z.a}) store3(out, 6 * k, a), store3(out, 6 * k + 3, V3{al[0], al[1], al[2]});
  }
}

template <For kFor>
LOCKSTEP_LANE void gather(const Plan& plan, const Link& link, const Numbers& z) {
  const RowArrays<LaneArray> rows{z.body, z.frames, z.law, z.J, z.c, z.C, z.Ct};
  link.triple ? write_rows<true, kFor>(plan, link, rows) : write_rows<false, kFor>(plan, link, rows);
}
LOCKSTEP_LANE void accelerate_rows(const Plan& plan, const Numbers& z) {
  for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
    gather<For::acceleration>(plan, plan.links[k], z);
    schur::with_rows<K, X>(
        plan.nodes[k], [&]<int M, bool kTurned>(const schur::Node& node) __attribute__((always_inline)) {
          schur::fill_own<K, X, M, kTurned>(plan, node, z);
          schur::start_link<K, X, M, kTurned>(plan, node, z);
        });
  }
}
LOCKSTEP_LANE void project_rows(const Plan& plan, const Numbers& z) {
  for (const Link& link : plan.links) gather<For::projection>(plan, link, z);
}
LOCKSTEP_LANE void own_blocks(const Plan& plan, const Numbers& z) { schur::fill_links<K, X>(plan, z); }

LOCKSTEP_LANE void factor_and_solve(const Plan& plan, const Numbers& z) {
  schur::fill_blocks<K, X>(plan, z);
  schur::factor_nodes<K, true>(plan, z);
  schur::solve_backward<K>(plan, z);
}
LOCKSTEP_LANE void solve(const Plan& plan, const Numbers& z) {
  schur::solve_forward<K>(plan, z);
  schur::solve_backward<K>(plan, z);
}
LOCKSTEP_LANE void apply(const Plan& plan, const Numbers& z) { schur::apply_links<K, X>(plan, z.x, z); }
LOCKSTEP_LANE void residual(const Plan& plan, const Numbers& z) { schur::residuals<K, X>(plan, z); }

LOCKSTEP_LANE void velocity_residual(const Plan& plan, const Numbers& z, const double* v, double* Cd) {
  schur::for_each_link<K, X>(
      plan, [&]<int M, bool kTurned>(const schur::Node& node) __attribute__((always_inline)) {
        V b[M];
        for (int k = 0; k < M; ++k) b[k] = K::number(z.Ct, node.x + k);
        schur::add_rows_times<K, X, M, kTurned>(plan, node, z, v, b);
        for (int k = 0; k < M; ++k) K::put(Cd, node.x + k, b[k]);
      });
}

LOCKSTEP_LANE void largest_scales(const Plan& plan, const Numbers& z, double* out) {
  V largest[3];
  schur::largest_by_kind<K>(plan, z.scale, largest);
  for (int k = 0; k < 3; ++k) K::put(out, k, largest[k]);
}
LOCKSTEP_LANE void energies(const Plan& plan, const Numbers& z, double* out) {
  V S[3];
  schur::largest_by_kind<K>(plan, z.diagonal, S);
  for (int k = 0; k < 3; ++k) K::put(out, k, S[k]);
  K::put(out, 3, schur::largest_energy<K, X>(plan, z, z.af) + schur::largest_energy<K, X>(plan, z, z.a));
}
LOCKSTEP_LANE void unmet(const Plan& plan, const Numbers& z, double tolerance, double* out) {
  V marks{};
  schur::check_rows<K>(plan, tolerance, z, marks);
  K::put(out, 0, marks);
}

// PivotWatch::see
LOCKSTEP_LANE void pivots(const Plan& plan, const Numbers& z, const double* left, double* out) {
  V n_small{}, smallest = V{} + 1.0;
  for (const schur::Node& node : plan.nodes)
    for (int k = 0; k < node.m; ++k) {
      const V pivot = 1.0 / K::number(z.p, node.x + k), diagonal = K::number(z.diagonal, node.x + k);
      const V kept = K::number(left, static_cast<int>(node.kinds.of(k)));
      const V small = what_counts_as_small(diagonal, kept);
      const V relative = pivot < small ? V{} + 1.0 : pivot / diagonal;
      n_small += pivot < small ? V{} + 1.0 : V{};
      smallest = relative < smallest ? relative : smallest;
    }
  K::put(out, 0, n_small), K::put(out, 1, smallest);
}

LOCKSTEP_LANE void norm(const Plan& plan, const double* c, const double* L, double* out) {
  V t{}, r{};
  for (const schur::Node& node : plan.nodes)
    for (int k = 0; k < node.m; ++k) {
      V& most = node.kinds.of(k) == RowKind::translation ? t : r;
      const V x = schur::size_of(K::number(c, node.x + k));
      most = largest_or_nan(most, x);
    }
  const V turned = 2.0 * K::number(L, 0) * r;
  K::put(out, 0, largest_or_nan(t, turned));
}

LOCKSTEP_LANE void rates(const Plan& plan, const Numbers& z, double* rate) {
  for (int k = 0; k < plan.n_slots; ++k) {
    const LaneArray q = LaneArray(z.y) + 7 * k, v = LaneArray(z.y) + (plan.v_at() + 6 * k);
    const LaneArray qd = LaneArray(rate) + 7 * k, vd = LaneArray(rate) + (plan.v_at() + 6 * k);
    const Q4 e = load4(q, 3);
    const V3 w = 0.5 * load3(v, 3);
    store3(qd, 0, load3(v, 0));
    qd[3] = -dot(e.v, w);  // (1.8)
    store3(qd, 4, e.w * w + cross(e.v, w));
    for (int i = 0; i < 6; ++i) vd[i] = LaneArray(z.a)[6 * k + i];
  }
}

LOCKSTEP_LANE void combine(std::size_t n, const double* y, const double* h, std::size_t n_k, const double* const* k,
                           const double* w, double* out, int lane) {
  const V step = LaneArray(h + lane)[0];
  const LaneArray from = y ? y + lane : nullptr, to = out + lane;
  for (std::size_t i = 0; i < n; ++i) {
    V sum{};
    for (std::size_t j = 0; j < n_k; ++j) sum += w[j] * LaneArray(k[j] + lane)[i];
    to[i] = from ? from[i] + step * sum : step * sum;
  }
}

/// Of all eight lanes.
LOCKSTEP_LANE void half_turns(const TreePlan& plan, const TreeStore& z, double* half) {
  for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
    const LaneNode& n = plan.nodes[k];
    if (n.turn != TreeTurn::hinge) continue;
    const double* q = z.y.data() + kL * (n.q + static_cast<std::size_t>(n.n_slides));
    for (std::size_t l = 0; l < kL; ++l) half[kL * k + l] = 0.5 * q[l];
  }
  sin_cos(half, kL * plan.nodes.size(), z.sine.data(), z.cosine.data());
}

/// The arrays, beginning at this lane.
LOCKSTEP_LANE Numbers from(const Numbers& z, int lane) {
  Numbers n = z;
  if (lane == 0) return n;
  for (const double** p : {&n.rows, &n.inverse, &n.mass, &n.floors, &n.y, &n.gravity, &n.frames, &n.law, &n.wrench})
    if (*p) *p += lane;
  for (double** p :
       {&n.A, &n.Y, &n.a, &n.x, &n.c, &n.scale, &n.diagonal, &n.p, &n.E, &n.r, &n.body, &n.af, &n.J, &n.C, &n.Ct})
    if (*p) *p += lane;
  return n;
}

LOCKSTEP_LANE auto at_lane(int lane) {
  return [lane](std::span<double> p) __attribute__((always_inline))->LaneArray {
    return p.empty() ? nullptr : p.data() + lane;
  };
}
/// Structs of packs, of the round that begins at this lane.
template <class S>
LOCKSTEP_LANE S* round_at(int lane, std::span<double> p) {
  return reinterpret_cast<S*>(p.data() + p.size() / kL * static_cast<std::size_t>(lane));
}
LOCKSTEP_LANE LaneTree<LaneArray> from(const TreePlan& plan, const TreeStore& z, int lane) {
  using Inertia = Space::Inertia;
  using Coordinate = bodies::Coordinate<Space>;
  static_assert(sizeof(Coordinate) == dof::size * sizeof(V) && sizeof(Travel<V>) == travel::size * sizeof(V) &&
                sizeof(Inertia) == articulated::size * sizeof(V));
  return {plan,
          {z.each(at_lane(lane)), round_at<Travel<V>>(lane, z.travel), round_at<Coordinate>(lane, z.dof),
           round_at<Inertia>(lane, z.waiting)}};
}
LOCKSTEP_LANE LaneClosures<LaneArray> from(const TreePlan& tree, const TreeStore& z, const ClosurePlan& plan,
                                           const ClosureStore& c, int lane) {
  static_assert(sizeof(Space::Wrench) == spatial::size * sizeof(V) && sizeof(Space::Twist) == sizeof(Space::Wrench));
  return {from(tree, z, lane),
          plan,
          {c.each(at_lane(lane)), round_at<Space::Wrench>(lane, c.K), round_at<Space::Wrench>(lane, c.wrench),
           round_at<Space::Twist>(lane, c.change)}};
}

// A pass over all eight lanes, in as many rounds as the packs need.
#define LOCKSTEP_PASS(name, parameters, act)              \
  all.name = [] parameters LOCKSTEP_TARGET {              \
    for (int lane = 0; lane < kLanes; lane += kWide) act; \
  };
#define LOCKSTEP_ROWS const Plan &plan, const Numbers &z
#define LOCKSTEP_TREE const TreePlan &plan, const TreeStore &z
#define LOCKSTEP_CLOSURES const TreePlan &tree, const TreeStore &z, const ClosurePlan &plan, const ClosureStore &c

Passes all_passes() {
  Passes all;
  LOCKSTEP_PASS(see_bodies, (LOCKSTEP_ROWS), see_bodies(plan, from(z, lane)))
  LOCKSTEP_PASS(free_motion, (LOCKSTEP_ROWS), free_motion(plan, from(z, lane)))
  LOCKSTEP_PASS(accelerate_rows, (LOCKSTEP_ROWS), accelerate_rows(plan, from(z, lane)))
  LOCKSTEP_PASS(project_rows, (LOCKSTEP_ROWS), project_rows(plan, from(z, lane)))
  LOCKSTEP_PASS(own_blocks, (LOCKSTEP_ROWS), own_blocks(plan, from(z, lane)))
  LOCKSTEP_PASS(residual, (LOCKSTEP_ROWS), residual(plan, from(z, lane)))
  LOCKSTEP_PASS(velocity_residual, (LOCKSTEP_ROWS, const double* v, double* Cd),
                velocity_residual(plan, from(z, lane), v + lane, Cd + lane))
  LOCKSTEP_PASS(largest_scales, (LOCKSTEP_ROWS, double* out), largest_scales(plan, from(z, lane), out + lane))
  LOCKSTEP_PASS(energies, (LOCKSTEP_ROWS, double* out), energies(plan, from(z, lane), out + lane))
  LOCKSTEP_PASS(unmet, (LOCKSTEP_ROWS, double tolerance, double* out),
                unmet(plan, from(z, lane), tolerance, out + lane))
  LOCKSTEP_PASS(pivots, (LOCKSTEP_ROWS, const double* left, double* out),
                pivots(plan, from(z, lane), left + lane, out + lane))
  LOCKSTEP_PASS(norm, (const Plan& plan, const double* c, const double* L, double* out),
                norm(plan, c + lane, L + lane, out + lane))
  LOCKSTEP_PASS(rates, (LOCKSTEP_ROWS, double* rate), rates(plan, from(z, lane), rate + lane))
  LOCKSTEP_PASS(combine,
                (std::size_t n, const double* y, const double* h, std::size_t n_k, const double* const* k,
                 const double* w, double* out),
                combine(n, y, h, n_k, k, w, out, lane))
  LOCKSTEP_PASS(factor_and_solve, (LOCKSTEP_ROWS), factor_and_solve(plan, from(z, lane)))
  LOCKSTEP_PASS(solve, (LOCKSTEP_ROWS), solve(plan, from(z, lane)))
  LOCKSTEP_PASS(apply, (LOCKSTEP_ROWS), apply(plan, from(z, lane)))
  LOCKSTEP_PASS(outward, (LOCKSTEP_TREE), from(plan, z, lane).outward())
  LOCKSTEP_PASS(accelerate_tree, (LOCKSTEP_TREE, double* rate), from(plan, z, lane).accelerate_free(rate + lane))
  LOCKSTEP_PASS(change, (LOCKSTEP_TREE, const double* before, const double* h, double* now, double* out),
                from(plan, z, lane).change(before + lane, h + lane, now + lane, out + lane))
  LOCKSTEP_PASS(vary, (LOCKSTEP_TREE, const double* dy, double* out), from(plan, z, lane).vary(dy + lane, out + lane))
  LOCKSTEP_PASS(accelerate_closed, (LOCKSTEP_CLOSURES, double* rate),
                from(tree, z, plan, c, lane).accelerate(rate + lane))
  LOCKSTEP_PASS(factor_closures, (LOCKSTEP_CLOSURES), from(tree, z, plan, c, lane).factor())
  LOCKSTEP_PASS(correct_closures, (LOCKSTEP_CLOSURES, const double* r, double* dv),
                from(tree, z, plan, c, lane).correct(r + lane, dv + lane))
  LOCKSTEP_PASS(add_correction, (LOCKSTEP_CLOSURES, const double* dv, double* rate),
                from(tree, z, plan, c, lane).add_correction(dv + lane, rate + lane))
  LOCKSTEP_PASS(closure_errors, (LOCKSTEP_CLOSURES), from(tree, z, plan, c, lane).errors())
  LOCKSTEP_PASS(closure_rates, (LOCKSTEP_CLOSURES), from(tree, z, plan, c, lane).rates())
  LOCKSTEP_PASS(closure_residuals, (LOCKSTEP_CLOSURES, bool raised, double* out),
                from(tree, z, plan, c, lane).residuals(raised, out + lane))
  LOCKSTEP_PASS(closure_pivots, (LOCKSTEP_CLOSURES, const double* left, double* out),
                from(tree, z, plan, c, lane).pivots(left + lane, out + lane))
  LOCKSTEP_PASS(closure_norm, (LOCKSTEP_CLOSURES, const double* x, const double* L, double* out),
                from(tree, z, plan, c, lane).norm(x + lane, L + lane, out + lane))
  all.half_turns = [](const TreePlan& plan, const TreeStore& z, double* half)
                       LOCKSTEP_TARGET { half_turns(plan, z, half); };
  return all;
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
