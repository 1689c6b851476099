// All passes for one instruction set: included once by lane_avx512.cpp, lane_fma.cpp and lane_plain.cpp, which define
// LOCKSTEP_SET, LOCKSTEP_WIDE and LOCKSTEP_TARGET. Private to the room.
#pragma once

#include <cmath>

#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/tools/batch/lane_blocks.h"
#include "framework/tools/batch/lane_closures.h"
#include "framework/tools/batch/lane_passes.h"
#include "framework/tools/batch/lane_rows.h"
#include "framework/tools/batch/lane_tree.h"

namespace lockstep::lanes::LOCKSTEP_SET {

LOCKSTEP_LANE void see_bodies(const Plan& plan, const Numbers& z) {
  for (int k = 0; k < plan.n_slots; ++k) {
    const double *q = z.y + kLanes * 7 * k, *v = z.y + kLanes * (plan.v_at() + 6 * k);
    double* b = z.body + kLanes * body::size * k;
    Q4 e = load4(q, 3);
    const V s = 1.0 / square_root(e.w * e.w + dot(e.v, e.v));
    e.w = s * e.w, e.v = s * e.v;
    const M3 A = rotation(e);
    const V3 w = load3(v, 3);
    store3(b, body::x, load3(q, 0));
    store3(b, body::A, A.r0), store3(b, body::A + 3, A.r1), store3(b, body::A + 6, A.r2);
    store(b, body::e, e.w), store3(b, body::e + 1, e.v);
    store3(b, body::v, load3(v, 0));
    store3(b, body::w, w);
    store3(b, body::W, A * w);
  }
}

using K = LaneBlocks;
using X = schur::Spatial;

// (2.8): f = m g + F | -w x J w + T
LOCKSTEP_LANE void free_motion(const Plan& plan, const Numbers& z) {
  const V3 g = load3(z.gravity, 0);
  for (int k = 0; k < plan.n_slots; ++k) {
    const double *M = K::at(z.mass, X::mass * k), *I = K::at(z.inverse, X::mass * k);
    const V3 w = load3(K::at(z.body, body::size * k), body::w);
    const V wk[3] = {w.x, w.y, w.z};
    V Jw[3], al[3];
    schur::inertia_times<K, X>(M, wk, Jw);
    V3 t = cross(V3{Jw[0], Jw[1], Jw[2]}, w), a = g;
    if (z.wrench) {
      const double* F = K::at(z.wrench, 6 * k);
      a = a + K::number(I, 0) * load3(F, 0);
      t = t + load3(F, 3);
    }
    const V tk[3] = {t.x, t.y, t.z};
    schur::inertia_times<K, X>(I, tk, al);
    for (double* out : {z.af, z.a}) store3(out, 6 * k, a), store3(out, 6 * k + 3, {al[0], al[1], al[2]});
  }
}

template <For kFor>
LOCKSTEP_LANE void gather(const Plan& plan, const Link& link, const Numbers& z) {
  link.triple ? rows<true, kFor>(plan, link, z) : rows<false, kFor>(plan, link, z);
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
  const V turned = 2.0 * load(L, 0) * r;
  store(out, 0, largest_or_nan(t, turned));
}

LOCKSTEP_LANE void rates(const Plan& plan, const Numbers& z, double* rate) {
  for (int k = 0; k < plan.n_slots; ++k) {
    const double *q = z.y + kLanes * 7 * k, *v = z.y + kLanes * (plan.v_at() + 6 * k);
    double *qd = rate + kLanes * 7 * k, *vd = rate + kLanes * (plan.v_at() + 6 * k);
    const Q4 e = load4(q, 3);
    const V3 w = 0.5 * load3(v, 3);
    store3(qd, 0, load3(v, 0));
    store(qd, 3, -dot(e.v, w));  // (1.8)
    store3(qd, 4, e.w * w + cross(e.v, w));
    for (int i = 0; i < 6; ++i) store(vd, i, load(z.a, 6 * k + i));
  }
}

LOCKSTEP_LANE void combine(std::size_t n, const double* y, const double* h, std::size_t n_k, const double* const* k,
                           const double* w, double* out, int lane) {
  const V step = load(h + lane, 0);
  for (std::size_t i = 0; i < n; ++i) {
    V sum{};
    for (std::size_t j = 0; j < n_k; ++j) sum += w[j] * load(k[j] + lane, i);
    store(out + lane, i, y ? load(y + lane, i) + step * sum : step * sum);
  }
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

// A pass over all eight lanes, in as many rounds as the packs need.
#define LOCKSTEP_PASS(name, parameters, arguments)                   \
  LOCKSTEP_TARGET void name##_pass parameters {                      \
    for (int lane = 0; lane < kLanes; lane += kWide) name arguments; \
  }
LOCKSTEP_PASS(see_bodies, (const Plan& plan, const Numbers& z), (plan, from(z, lane)))
LOCKSTEP_PASS(free_motion, (const Plan& plan, const Numbers& z), (plan, from(z, lane)))
LOCKSTEP_PASS(accelerate_rows, (const Plan& plan, const Numbers& z), (plan, from(z, lane)))
LOCKSTEP_PASS(project_rows, (const Plan& plan, const Numbers& z), (plan, from(z, lane)))
LOCKSTEP_PASS(own_blocks, (const Plan& plan, const Numbers& z), (plan, from(z, lane)))
LOCKSTEP_PASS(residual, (const Plan& plan, const Numbers& z), (plan, from(z, lane)))
LOCKSTEP_PASS(velocity_residual, (const Plan& plan, const Numbers& z, const double* v, double* Cd),
              (plan, from(z, lane), v + lane, Cd + lane))
LOCKSTEP_PASS(largest_scales, (const Plan& plan, const Numbers& z, double* out), (plan, from(z, lane), out + lane))
LOCKSTEP_PASS(energies, (const Plan& plan, const Numbers& z, double* out), (plan, from(z, lane), out + lane))
LOCKSTEP_PASS(unmet, (const Plan& plan, const Numbers& z, double tolerance, double* out),
              (plan, from(z, lane), tolerance, out + lane))
LOCKSTEP_PASS(pivots, (const Plan& plan, const Numbers& z, const double* left, double* out),
              (plan, from(z, lane), left + lane, out + lane))
LOCKSTEP_PASS(norm, (const Plan& plan, const double* c, const double* L, double* out),
              (plan, c + lane, L + lane, out + lane))
LOCKSTEP_PASS(rates, (const Plan& plan, const Numbers& z, double* rate), (plan, from(z, lane), rate + lane))
LOCKSTEP_PASS(combine,
              (std::size_t n, const double* y, const double* h, std::size_t n_k, const double* const* k,
               const double* w, double* out),
              (n, y, h, n_k, k, w, out, lane))
LOCKSTEP_PASS(factor_and_solve, (const Plan& plan, const Numbers& z), (plan, from(z, lane)))
LOCKSTEP_PASS(solve, (const Plan& plan, const Numbers& z), (plan, from(z, lane)))
LOCKSTEP_PASS(apply, (const Plan& plan, const Numbers& z), (plan, from(z, lane)))
LOCKSTEP_PASS(outward, (const TreePlan& plan, const TreeNumbers& z), (plan, from(plan, z, lane)))
LOCKSTEP_PASS(accelerate_tree, (const TreePlan& plan, const TreeNumbers& z, double* rate),
              (plan, from(plan, z, lane), rate + lane))
LOCKSTEP_PASS(change,
              (const TreePlan& plan, const TreeNumbers& z, const double* before, const double* h, double* now,
               double* out),
              (plan, from(plan, z, lane), before + lane, h + lane, now + lane, out + lane))
LOCKSTEP_PASS(vary, (const TreePlan& plan, const TreeNumbers& z, const double* dy, double* out),
              (plan, from(plan, z, lane), dy + lane, out + lane))
LOCKSTEP_PASS(accelerate_closed,
              (const TreePlan& tree, const TreeNumbers& z, const ClosurePlan& plan, const ClosureNumbers& c,
               double* rate),
              (tree, from(tree, z, lane), plan, from(plan, c, lane), rate + lane))
LOCKSTEP_PASS(factor_closures,
              (const TreePlan& tree, const TreeNumbers& z, const ClosurePlan& plan, const ClosureNumbers& c),
              (tree, from(tree, z, lane), plan, from(plan, c, lane)))
LOCKSTEP_PASS(correct_closures,
              (const TreePlan& tree, const TreeNumbers& z, const ClosurePlan& plan, const ClosureNumbers& c,
               const double* r, double* dv),
              (tree, from(tree, z, lane), plan, from(plan, c, lane), r + lane, dv + lane))
LOCKSTEP_PASS(add_correction,
              (const TreePlan& tree, const TreeNumbers& z, const ClosurePlan& plan, const ClosureNumbers& c,
               const double* dv, double* rate),
              (tree, from(tree, z, lane), plan, from(plan, c, lane), dv + lane, rate + lane))
LOCKSTEP_PASS(closure_errors, (const TreeNumbers& z, const ClosurePlan& plan, const ClosureNumbers& c),
              (plan, from(z, lane), from(plan, c, lane)))
LOCKSTEP_PASS(closure_rates, (const TreeNumbers& z, const ClosurePlan& plan, const ClosureNumbers& c),
              (plan, from(z, lane), from(plan, c, lane)))
LOCKSTEP_PASS(closure_residuals,
              (const TreeNumbers& z, const ClosurePlan& plan, const ClosureNumbers& c, bool raised, double* out),
              (plan, from(z, lane), from(plan, c, lane), raised, out + lane))
LOCKSTEP_PASS(closure_pivots, (const ClosurePlan& plan, const ClosureNumbers& c, const double* left, double* out),
              (plan, from(plan, c, lane), left + lane, out + lane))
LOCKSTEP_PASS(closure_norm, (const ClosurePlan& plan, const double* x, const double* L, double* out),
              (plan, x + lane, L + lane, out + lane))
LOCKSTEP_TARGET void half_turns_pass(const TreePlan& plan, const TreeNumbers& z) { half_turns(plan, z); }

Passes all_passes() {
  Passes out;
  out.see_bodies = see_bodies_pass;
  out.free_motion = free_motion_pass;
  out.accelerate_rows = accelerate_rows_pass;
  out.project_rows = project_rows_pass;
  out.own_blocks = own_blocks_pass;
  out.residual = residual_pass;
  out.velocity_residual = velocity_residual_pass;
  out.largest_scales = largest_scales_pass;
  out.energies = energies_pass;
  out.unmet = unmet_pass;
  out.pivots = pivots_pass;
  out.norm = norm_pass;
  out.rates = rates_pass;
  out.combine = combine_pass;
  out.factor_and_solve = factor_and_solve_pass;
  out.solve = solve_pass;
  out.apply = apply_pass;
  out.half_turns = half_turns_pass;
  out.outward = outward_pass;
  out.accelerate_tree = accelerate_tree_pass;
  out.change = change_pass;
  out.vary = vary_pass;
  out.accelerate_closed = accelerate_closed_pass;
  out.factor_closures = factor_closures_pass;
  out.correct_closures = correct_closures_pass;
  out.add_correction = add_correction_pass;
  out.closure_errors = closure_errors_pass;
  out.closure_rates = closure_rates_pass;
  out.closure_residuals = closure_residuals_pass;
  out.closure_pivots = closure_pivots_pass;
  out.closure_norm = closure_norm_pass;
  return out;
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
