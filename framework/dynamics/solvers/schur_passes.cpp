// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/solvers/schur_passes.h"

#include <lockstep/detail/export.h>

namespace lockstep::schur {
namespace {

// What goes into the elimination (elimination.h), node by node: S + E from the rows and masses, and right-hand sides.

// ------------------------------------------------------------------------------------------------- rows -> S

/// Diagonal of J M^-1 J^T over the hubs that a link touches: not in its block, but part of its scale.
template <class X, int M, bool kTurned>
void add_hub_diagonal(const Plan& plan, const Node& node, const Numbers& z, double* diagonal) {
  constexpr int kAngular = kTurned ? 0 : X::nv;  // first column of the angular part
  for (const Side& side : plan.sides_of(node)) {
    if (!side.hub) continue;
    const double* I = z.inverse + X::mass * side.slot;
    for (int i = 0; i < M; ++i) {
      const auto J = [&](int c) { return z.rows[side.J + c * pack_size(M) + i]; };
      if (kTurned && i < X::nv) diagonal[i] += I[0];
      for (int c = 0; c < kAngular; ++c) diagonal[i] += I[0] * J(c) * J(c);
      for (int c = 0; c < X::nw; ++c)
        for (int k = 0; k < X::nw; ++k) diagonal[i] += J(kAngular + c) * I[X::I[c][k]] * J(kAngular + k);
    }
  }
}

/// Y = J M^-1 of one link and its own block of S + E; a hub has its own columns instead.
template <class X, int M, bool kTurned, int ld = pack_size(M)>
LOCKSTEP_INLINE void fill_own(const Plan& plan, const Node& node, const Numbers& z) {
  constexpr int kAngular = kTurned ? 0 : X::nv;
  Pack<ld> D[M] = {};
  double linear = 0, diagonal[M];
  for (const Side& side : plan.sides_of(node)) {
    const double *J = z.rows + side.J, *I = z.inverse + X::mass * side.slot;
    double* Y = z.Y + side.Y;
    const bool own = !side.hub;
    const auto column = [&](int c) __attribute__((always_inline))->Pack<ld> { return pack<ld>(J + c * ld); };
    const auto take = [&](int c, const Pack<ld>& y) __attribute__((always_inline)) {
      pack<ld>(Y + c * ld) = y;
      if (own) unrolled<M>([&](auto j) __attribute__((always_inline)) { D[j] += y * J[c * ld + j]; });
    };
    for (int c = 0; c < kAngular; ++c) take(c, column(c) * I[0]);
    for (int c = 0; c < X::nw; ++c) {
      Pack<ld> y = column(kAngular) * I[X::I[c][0]];
      for (int k = 1; k < X::nw; ++k) y += column(kAngular + k) * I[X::I[c][k]];
      take(kAngular + c, y);
    }
    if (own) linear += I[0];
  }
  for (int i = 0; i < M; ++i) {
    if (kTurned && i < X::nv) D[i][i] += linear;
    diagonal[i] = D[i][i];
  }
  if (node.on_hub) add_hub_diagonal<X, M, kTurned>(plan, node, z, diagonal);
  if (z.eps > 0) {  // E = eps s
    double s[M];
    for (int i = 0; i < M; ++i) s[i] = diagonal[i];
    average_scales(s, M, node.kinds);
    for (int i = 0; i < M; ++i) {
      const double e = z.E[node.x + i] = z.eps * s[i];
      D[i][i] += e, diagonal[i] += e;
    }
  }
  for (int i = 0; i < M; ++i) z.diagonal[node.x + i] = diagonal[i];
  for (int k = 0; k < M; ++k) pack<ld>(z.A + node.D + k * ld) = D[k];
}

/// Adds the share of a slot to the block between two links of one size, both turned: J_q M^-1 J_p^T, p of the pivot.
/// `first`: the block is written, not added to.
template <class X, int M, int ld = pack_size(M)>
LOCKSTEP_INLINE void add_term(const Side& p, const Side& q, const Numbers& z, double* block, bool first) {
  const double *Y = z.Y + p.Y, *J = z.rows + q.J;
  const double linear = p.sign * q.sign * z.inverse[X::mass * p.slot];
  Pack<ld> Jc[X::nw];
  for (int c = 0; c < X::nw; ++c) Jc[c] = pack<ld>(J + c * ld);
  for (int i = 0; i < M; ++i) {
    Pack<ld> a = first ? Pack<ld>{} : pack<ld>(block + i * ld);
    for (int c = 0; c < X::nw; ++c) a += Jc[c] * Y[c * ld + i];
    if (i < X::nv) a[i] += linear;
    pack<ld>(block + i * ld) = a;
  }
}

/// The same for any two links, of m_p and m_q rows, number by number.
template <class X>
LOCKSTEP_INLINE void add_any_term(int m_p, const Side& p, int m_q, const Side& q, const Numbers& z, double* block) {
  const auto Y = [&](int c, int i) __attribute__((always_inline)) { return (z.Y + p.Y)[c * pack_size(m_p) + i]; };
  const auto J = [&](int c, int j) __attribute__((always_inline)) { return (z.rows + q.J)[c * pack_size(m_q) + j]; };
  const int first_p = p.turned ? 0 : X::nv, first_q = q.turned ? 0 : X::nv;  // columns of the angular parts
  const double im = z.inverse[X::mass * p.slot];
  for (int i = 0; i < m_p; ++i)
    for (int j = 0; j < m_q; ++j) {
      double s = J(first_q, j) * Y(first_p, i);
      for (int c = 1; c < X::nw; ++c) s += J(first_q + c, j) * Y(first_p + c, i);
      if (p.turned && q.turned) {
        if (i == j && i < X::nv) s += p.sign * q.sign * im;
      } else if (p.turned) {
        if (i < X::nv) s += p.sign * im * J(i, j);
      } else if (q.turned) {
        if (j < X::nv) s += q.sign * Y(j, i);
      } else {
        for (int c = 0; c < X::nv; ++c) s += J(c, j) * Y(c, i);
      }
      block[i * pack_size(m_q) + j] += s;
    }
}

/// -J of a link on a hub: the block between the two, whichever goes first.
template <class X>
void add_hub_term(const Plan& plan, const Node& pivot, const Later& later, const Term& term, const Numbers& z,
                  double* block) {
  const bool hub_first = term.pivot_side < 0;
  const Side& side = plan.sides[hub_first ? term.later_side : term.pivot_side];
  const int m = hub_first ? later.m : pivot.m;
  const auto J = [&](int row, int c) {
    if (side.turned && c < X::nv) return row == c ? side.sign : 0.0;
    return (z.rows + side.J)[(side.turned ? c - X::nv : c) * pack_size(m) + row];
  };
  for (int i = 0; i < pivot.m; ++i)
    for (int j = 0; j < later.m; ++j) block[i * pack_size(later.m) + j] -= hub_first ? J(j, i) : J(i, j);
}

/// The block between a pivot and one later node: a sum over the slots that both touch.
template <class X, int M>
LOCKSTEP_INLINE void fill_below(const Plan& plan, const Node& node, const Later& later, const Numbers& z) {
  double* block = z.A + later.block;
  const auto clear = [&] { std::fill_n(block, M * pack_size(later.m), 0.0); };
  if (later.n_terms == 0) clear();
  bool first = true;  // the block is to be written
  for (const Term& term : plan.terms_of(later)) {
    const bool on_hub = term.pivot_side < 0 || term.later_side < 0;
    const Side *p = plan.sides.data() + term.pivot_side, *q = plan.sides.data() + term.later_side;
    if (M >= X::nv && later.m == M && !on_hub && p->turned && q->turned) {
      add_term<X, M>(*p, *q, z, block, first);
    } else {
      if (first) clear();
      on_hub ? add_hub_term<X>(plan, node, later, term, z, block) : add_any_term<X>(M, *p, later.m, *q, z, block);
    }
    first = false;
  }
}

/// The mass of a hub, negative.
template <class X>
void fill_hub(const Node& node, const Numbers& z) {
  const double* M = z.mass + X::mass * node.hub_slot;
  double* D = z.A + node.D;
  const int ld = node.ld();
  std::fill_n(D, node.m * ld, 0.0);
  for (int i = 0; i < X::nv; ++i) D[i * ld + i] = -M[0];
  for (int i = 0; i < X::nw; ++i)
    for (int k = 0; k < X::nw; ++k) D[(X::nv + i) * ld + X::nv + k] = -M[X::I[i][k]];
  for (int i = 0; i < node.m; ++i) z.diagonal[node.x + i] = -D[i * ld + i];
}

// ------------------------------------------------------------------------------------------------- right-hand sides

/// J a of one link and slot, in the axes that its rows are kept in.
template <class X, int M, bool kTurned, int ld = pack_size(M)>
LOCKSTEP_INLINE Pack<ld> rows_times_a(const Side& side, const Numbers& z) {
  const double *J = z.rows + side.J, *a = z.a + X::a * side.slot;
  constexpr int kFirst = kTurned ? X::nv : 0;
  const auto term = [&](int c) __attribute__((always_inline))->Pack<ld> {
    return pack<ld>(J + (c - kFirst) * ld) * a[c];
  };
  Pack<ld> t = kTurned ? numbers<ld>(a, 0, X::nv) * side.sign : term(0);
  for (int c = kTurned ? X::nv : 1; c < X::n; ++c) t += term(c);
  return t;
}

/// c of one link, turned from its own axes to those in which its rows are stored.
template <class X, int M, bool kTurned, int ld = pack_size(M)>
LOCKSTEP_INLINE void turn_link(const Node& node, const double* given, const Numbers& z) {
  Pack<ld> c = numbers<ld>(given, kTurned ? X::nv : 0, M);
  if constexpr (kTurned) {
    const double* R = z.rows + node.R;
    for (int k = 0; k < X::nv; ++k) c += pack<ld>(R + k * ld) * given[k];
  }
  pack<ld>(z.c + node.x) = c;
}
/// x = J a - c of one link and the scales |J a| + |c|; a on hubs is still unknown, and only enters the scale.
template <class X, int M, bool kTurned, int ld = pack_size(M)>
LOCKSTEP_INLINE void start_link(const Plan& plan, const Node& node, const Numbers& z) {
  Pack<ld> b = {}, on_hubs = {};
  for (const Side& side : plan.sides_of(node)) (side.hub ? on_hubs : b) += rows_times_a<X, M, kTurned>(side, z);
  const Pack<ld> c = pack<ld>(z.c + node.x), sum = b + on_hubs;
  pack<ld>(z.x + node.x) = b - c;
  pack<ld>(z.scale + node.x) = size_of(sum) + size_of(c);
}

/// a -= Y^T x
template <class X, int M, bool kTurned>
LOCKSTEP_INLINE void apply_link(const Plan& plan, const Node& node, const double* x, const Numbers& z) {
  constexpr int kFirst = kTurned ? X::nv : 0;
  for (const Side& side : plan.sides_of(node)) {
    const double* Y = z.Y + side.Y;
    double* a = z.a + X::a * side.slot;
    if constexpr (kTurned) {
      const double k = side.sign * z.inverse[X::mass * side.slot];
      for (int c = 0; c < X::nv; ++c) a[c] -= k * x[c];
    }
    for (int c = kFirst; c < X::n; ++c) {
      double t = 0;
      for (int i = 0; i < M; ++i) t += Y[(c - kFirst) * pack_size(M) + i] * x[i];
      a[c] -= t;
    }
  }
}

/// r = J a - c
template <class X, int M, bool kTurned, int ld = pack_size(M)>
LOCKSTEP_INLINE void residual_link(const Plan& plan, const Node& node, const Numbers& z) {
  Pack<ld> r = -pack<ld>(z.c + node.x);
  for (const Side& side : plan.sides_of(node)) r += rows_times_a<X, M, kTurned>(side, z);
  pack<ld>(z.r + node.x) = r;
}

/// Whether |r| is within `tolerance` of the scale, which is at least the floor, in each row; a NaN never is.
LOCKSTEP_INLINE bool link_met(const Node& node, double tolerance, const Numbers& z) {
  bool met = true;
  with_column(
      node.m, [&](auto n) __attribute__((always_inline)) {
        const double* kind = z.kind + 3 * node.x;
        const Pack<n> floor =
            pack<n>(kind) * z.floors[0] + pack<n>(kind + n) * z.floors[1] + pack<n>(kind + 2 * n) * z.floors[2];
        const Pack<n> r = pack<n>(z.r + node.x), scale = pack<n>(z.scale + node.x);
        const auto within = size_of(r) <= tolerance * larger(scale, floor);
        for (int i = 0; i < n; ++i) met = met && within[i];
      });
  return met;
}

// ------------------------------------------------------------------------------------------------------------- passes

/// Calls f(node, M, kTurned) for each link, with its rows and whether they are turned as constants.
template <class X, class F>
LOCKSTEP_INLINE void for_each_link(const Plan& plan, F&& f) {
  for (const Node& node : plan.nodes) {
    if (node.link < 0) continue;
    if (node.turned)
      for_size<X::nv>(
          node.m, [&](auto m) __attribute__((always_inline)) { f(node, m, std::true_type{}); });
    else
      for_size(
          node.m, [&](auto m) __attribute__((always_inline)) { f(node, m, std::false_type{}); });
  }
}

template <class X>
LOCKSTEP_INLINE void fill_links(const Plan& plan, const Numbers& z) {
  for_each_link<X>(
      plan, [&](const Node& node, auto m, auto turned)
                __attribute__((always_inline)) { fill_own<X, m, turned>(plan, node, z); });
}
template <class X>
LOCKSTEP_INLINE void fill_blocks(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    if (node.n_later > 0)
      for_size(
          node.m, [&](auto m) __attribute__((always_inline)) {
            for (const Later& later : plan.later_of(node)) fill_below<X, m>(plan, node, later, z);
          });
}
template <class X>
LOCKSTEP_INLINE void start_links(const Plan& plan, const double* c, const Numbers& z) {
  for_each_link<X>(
      plan, [&](const Node& node, auto m, auto turned) __attribute__((always_inline)) {
        turn_link<X, m, turned>(node, c + node.first_row, z);
        start_link<X, m, turned>(plan, node, z);
      });
}
template <class X>
LOCKSTEP_INLINE void apply_links(const Plan& plan, const double* x, const Numbers& z) {
  for_each_link<X>(
      plan, [&](const Node& node, auto m, auto turned)
                __attribute__((always_inline)) { apply_link<X, m, turned>(plan, node, x + node.x, z); });
}
template <class X>
LOCKSTEP_INLINE void residuals(const Plan& plan, const Numbers& z) {
  for_each_link<X>(
      plan, [&](const Node& node, auto m, auto turned)
                __attribute__((always_inline)) { residual_link<X, m, turned>(plan, node, z); });
}

// No header declares these: of a function that was declared without the attribute clang 14 takes the first variant for
// every machine.
LOCKSTEP_CLONES void fill_spatial(const Plan& plan, const Numbers& z) { fill_links<Spatial>(plan, z); }
LOCKSTEP_CLONES void fill_planar(const Plan& plan, const Numbers& z) { fill_links<Planar>(plan, z); }
LOCKSTEP_CLONES void fill_blocks_spatial(const Plan& plan, const Numbers& z) { fill_blocks<Spatial>(plan, z); }
LOCKSTEP_CLONES void fill_blocks_planar(const Plan& plan, const Numbers& z) { fill_blocks<Planar>(plan, z); }
LOCKSTEP_CLONES void start_spatial(const Plan& plan, const double* c, const Numbers& z) {
  start_links<Spatial>(plan, c, z);
}
LOCKSTEP_CLONES void start_planar(const Plan& plan, const double* c, const Numbers& z) {
  start_links<Planar>(plan, c, z);
}
LOCKSTEP_CLONES void apply_spatial(const Plan& plan, const double* x, const Numbers& z) {
  apply_links<Spatial>(plan, x, z);
}
LOCKSTEP_CLONES void apply_planar(const Plan& plan, const double* x, const Numbers& z) {
  apply_links<Planar>(plan, x, z);
}
LOCKSTEP_CLONES void residual_spatial(const Plan& plan, const Numbers& z) { residuals<Spatial>(plan, z); }
LOCKSTEP_CLONES void residual_planar(const Plan& plan, const Numbers& z) { residuals<Planar>(plan, z); }
LOCKSTEP_CLONES void factor_all(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    for_size(
        node.m, [&](auto m) __attribute__((always_inline)) { eliminate<m>(plan, node, z); });
}
LOCKSTEP_CLONES void solve_all(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    for_size(
        node.m, [&](auto m) __attribute__((always_inline)) { forward<m>(plan, node, z); });
  for (auto node = plan.nodes.rbegin(); node != plan.nodes.rend(); ++node)
    for_size(
        node->m, [&](auto m) __attribute__((always_inline)) { backward<m>(plan, *node, z); });
}
LOCKSTEP_CLONES bool all_rows_met(const Plan& plan, double tolerance, const Numbers& z) {
  for (const Node& node : plan.nodes)
    if (node.link >= 0 && !link_met(node, tolerance, z)) return false;
  return true;
}

}  // namespace

void fill(const Plan& plan, const Numbers& z) {
  plan.planar ? fill_planar(plan, z) : fill_spatial(plan, z);
  for (const int h : plan.hubs) plan.planar ? fill_hub<Planar>(plan.nodes[h], z) : fill_hub<Spatial>(plan.nodes[h], z);
  plan.planar ? fill_blocks_planar(plan, z) : fill_blocks_spatial(plan, z);
}
void start(const Plan& plan, const double* c, const Numbers& z) {
  plan.planar ? start_planar(plan, c, z) : start_spatial(plan, c, z);
}
void apply(const Plan& plan, const double* x, const Numbers& z) {
  plan.planar ? apply_planar(plan, x, z) : apply_spatial(plan, x, z);
}
void residual(const Plan& plan, const Numbers& z) {
  plan.planar ? residual_planar(plan, z) : residual_spatial(plan, z);
}

void factor(const Plan& plan, const Numbers& z) { factor_all(plan, z); }
void solve(const Plan& plan, const Numbers& z) { solve_all(plan, z); }
bool rows_met(const Plan& plan, double tolerance, const Numbers& z) { return all_rows_met(plan, tolerance, z); }

}  // namespace lockstep::schur
