// All passes for one set of instructions: included once by lane_avx512.cpp, lane_fma.cpp and lane_plain.cpp, which say
// LOCKSTEP_SET, LOCKSTEP_WIDE and LOCKSTEP_TARGET. Private to the room.
#pragma once

#include <cmath>

#include "framework/tools/batch/lane_factor.h"
#include "framework/tools/batch/lane_passes.h"
#include "framework/tools/batch/lane_rows.h"

namespace lockstep::lanes::LOCKSTEP_SET {

LOCKSTEP_LANE V square_root(const V& a) {
  V r;
  for (int l = 0; l < kWide; ++l) r[l] = std::sqrt(a[l]);
  return r;
}

LOCKSTEP_LANE void see_bodies(const Plan& plan, const Numbers& z) {
  for (int k = 0; k < plan.n_slots; ++k) {
    const double *q = z.y + kLanes * 7 * at(k), *v = z.y + kLanes * (plan.v_at() + 6 * at(k));
    double* b = z.body + kLanes * body::size * at(k);
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

// (2.8): f = m g + F | -w x J w + T
LOCKSTEP_LANE void free_motion(const Plan& plan, const Numbers& z) {
  const V3 g = load3(z.gravity, 0);
  for (int k = 0; k < plan.n_slots; ++k) {
    const double *m = mass_of(z, k), *b = z.body + kLanes * body::size * at(k);
    const V3 w = load3(b, body::w);
    V J[6], I[6];
    for (int i = 0; i < 6; ++i) J[i] = load(m, mass::J + at(i)), I[i] = load(m, mass::Jinv + at(i));
    const V3 Jw = {J[0] * w.x + J[1] * w.y + J[2] * w.z, J[1] * w.x + J[3] * w.y + J[4] * w.z,
                   J[2] * w.x + J[4] * w.y + J[5] * w.z};
    V3 t = cross(Jw, w), a = g;
    if (z.wrench) {
      const double* F = z.wrench + kLanes * 6 * at(k);
      a = a + load(m, mass::inverse) * load3(F, 0);
      t = t + load3(F, 3);
    }
    const V3 al = {I[0] * t.x + I[1] * t.y + I[2] * t.z, I[1] * t.x + I[3] * t.y + I[4] * t.z,
                   I[2] * t.x + I[4] * t.y + I[5] * t.z};
    store3(z.af, 6 * at(k), a), store3(z.af, 6 * at(k) + 3, al);
    store3(z.a, 6 * at(k), a), store3(z.a, 6 * at(k) + 3, al);
  }
}

LOCKSTEP_LANE void accelerate_rows(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes) {
    node.triple ? rows<true, For::acceleration>(plan, node, z) : rows<false, For::acceleration>(plan, node, z);
    with_shape(
        node, [&]<int M, bool T>() __attribute__((always_inline)) { own<M, T, true>(plan, node, z); });
    for (int k = 0; k < node.m; ++k) store(z.lambda, node.x + at(k), V{});
  }
}

LOCKSTEP_LANE void project_rows(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    node.triple ? rows<true, For::projection>(plan, node, z) : rows<false, For::projection>(plan, node, z);
}

LOCKSTEP_LANE void own_blocks(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    with_shape(
        node, [&]<int M, bool T>() __attribute__((always_inline)) { own<M, T, false>(plan, node, z); });
}

LOCKSTEP_LANE void residual(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    with_shape(
        node, [&]<int M, bool T>() __attribute__((always_inline)) {
          V b[M];
          for (int k = 0; k < M; ++k) b[k] = -load(z.c, node.x + at(k));
          times<M, T>(plan, node, z, z.a, 6, b);
          for (int k = 0; k < M; ++k) store(z.r, node.x + at(k), b[k]);
        });
}

LOCKSTEP_LANE void shift(const Plan& plan, const Numbers& z) {
  for (std::size_t i = 0; i < plan.size_x; ++i) store(z.x, i, load(z.E, i) * load(z.lambda, i));
}

LOCKSTEP_LANE void velocity_residual(const Plan& plan, const Numbers& z, const double* v, double* Cd) {
  for (const Node& node : plan.nodes)
    with_shape(
        node, [&]<int M, bool T>() __attribute__((always_inline)) {
          V b[M];
          for (int k = 0; k < M; ++k) b[k] = load(z.Ct, node.x + at(k));
          times<M, T>(plan, node, z, v, 6, b);
          for (int k = 0; k < M; ++k) store(Cd, node.x + at(k), b[k]);
        });
}

LOCKSTEP_LANE void largest_scales(const Plan& plan, const Numbers& z, double* out) {
  V t{}, r{};
  for (const Node& node : plan.nodes)
    for (int k = 0; k < node.m; ++k) {
      V& most = node.kind[at(k)] == RowKind::translation ? t : r;
      most = larger(most, load(z.scale, node.x + at(k)));
    }
  store(out, 0, t), store(out, 1, r);
}

LOCKSTEP_LANE void energies(const Plan& plan, const Numbers& z, double* out) {
  V t{}, r{}, most{};
  for (const Node& node : plan.nodes)
    for (int k = 0; k < node.m; ++k) {
      V& of_kind = node.kind[at(k)] == RowKind::translation ? t : r;
      of_kind = larger(of_kind, load(z.diagonal, node.x + at(k)));
    }
  for (int k = 0; k < plan.n_slots; ++k) {
    const double* m = mass_of(z, k);
    V sum{};
    for (const double* a : {z.af, z.a}) {
      const V3 v = load3(a, 6 * at(k)), w = load3(a, 6 * at(k) + 3);
      V J[6];
      for (int i = 0; i < 6; ++i) J[i] = load(m, mass::J + at(i));
      sum += load(m, mass::m) * dot(v, v) + J[0] * w.x * w.x + J[3] * w.y * w.y + J[5] * w.z * w.z +
             2.0 * (J[1] * w.x * w.y + J[2] * w.x * w.z + J[4] * w.y * w.z);
    }
    most = larger(most, sum);
  }
  store(out, 0, t), store(out, 1, r), store(out, 2, most);
}

LOCKSTEP_LANE void unmet(const Plan& plan, const Numbers& z, const double* floors, double tolerance, double* out) {
  V bad{};
  const V one = V{} + 1.0, t = load(floors, 0), r = load(floors, 1);
  for (const Node& node : plan.nodes)
    for (int k = 0; k < node.m; ++k) {
      const V limit =
          tolerance * larger(load(z.scale, node.x + at(k)), node.kind[at(k)] == RowKind::translation ? t : r);
      bad = size_of(load(z.r, node.x + at(k))) <= limit ? bad : one;
    }
  store(out, 0, bad);
}

LOCKSTEP_LANE void norm(const Plan& plan, const double* c, const double* L, double* out) {
  V t{}, r{};
  for (const Node& node : plan.nodes)
    for (int k = 0; k < node.m; ++k) {
      V& most = node.kind[at(k)] == RowKind::translation ? t : r;
      const V x = size_of(load(c, node.x + at(k)));
      most = x <= most ? most : x;  // a NaN stays
    }
  const V turned = 2.0 * load(L, 0) * r;
  store(out, 0, turned <= t ? t : turned);
}

LOCKSTEP_LANE void rates(const Plan& plan, const Numbers& z, double* rate) {
  for (int k = 0; k < plan.n_slots; ++k) {
    const double *q = z.y + kLanes * 7 * at(k), *v = z.y + kLanes * (plan.v_at() + 6 * at(k));
    double *qd = rate + kLanes * 7 * at(k), *vd = rate + kLanes * (plan.v_at() + 6 * at(k));
    const Q4 e = load4(q, 3);
    const V3 w = 0.5 * load3(v, 3);
    store3(qd, 0, load3(v, 0));
    store(qd, 3, -dot(e.v, w));  // (1.8)
    store3(qd, 4, e.w * w + cross(e.v, w));
    for (int i = 0; i < 6; ++i) store(vd, at(i), load(z.a, 6 * at(k) + at(i)));
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

/// The arrays from this lane on.
LOCKSTEP_LANE Numbers from(const Numbers& z, int lane) {
  Numbers n = z;
  if (lane == 0) return n;
  if (n.wrench) n.wrench += lane;
  n.y += lane, n.mass += lane, n.gravity += lane, n.frames += lane, n.law += lane;
  n.body += lane, n.af += lane, n.a += lane, n.J += lane, n.Y += lane;
  n.A += lane, n.x += lane, n.c += lane, n.scale += lane, n.diagonal += lane;
  n.E += lane, n.lambda += lane, n.r += lane, n.C += lane, n.Ct += lane;
  return n;
}

// The pass of all eight lanes: as many rounds as packs make a row.
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
LOCKSTEP_PASS(shift, (const Plan& plan, const Numbers& z), (plan, from(z, lane)))
LOCKSTEP_PASS(velocity_residual, (const Plan& plan, const Numbers& z, const double* v, double* Cd),
              (plan, from(z, lane), v + lane, Cd + lane))
LOCKSTEP_PASS(largest_scales, (const Plan& plan, const Numbers& z, double* out), (plan, from(z, lane), out + lane))
LOCKSTEP_PASS(energies, (const Plan& plan, const Numbers& z, double* out), (plan, from(z, lane), out + lane))
LOCKSTEP_PASS(unmet, (const Plan& plan, const Numbers& z, const double* floors, double tolerance, double* out),
              (plan, from(z, lane), floors + lane, tolerance, out + lane))
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

Passes all_passes() {
  Passes out;
  out.see_bodies = see_bodies_pass;
  out.free_motion = free_motion_pass;
  out.accelerate_rows = accelerate_rows_pass;
  out.project_rows = project_rows_pass;
  out.own_blocks = own_blocks_pass;
  out.residual = residual_pass;
  out.shift = shift_pass;
  out.velocity_residual = velocity_residual_pass;
  out.largest_scales = largest_scales_pass;
  out.energies = energies_pass;
  out.unmet = unmet_pass;
  out.norm = norm_pass;
  out.rates = rates_pass;
  out.combine = combine_pass;
  out.factor_and_solve = factor_and_solve_pass;
  out.solve = solve_pass;
  out.apply = apply_pass;
  return out;
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
