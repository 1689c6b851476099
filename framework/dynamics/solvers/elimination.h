// SPDX-License-Identifier: BSD-3-Clause
// The elimination of S = J M^-1 J^T + E over the graph of the links, node by node (framework/docs/solvers.md, sections
// 2 and 5): the numeric half. Letters:
//
//   Y = J M^-1,   T^T p T the inverse of a pivot's block (T unit lower triangular, p diagonal),   L = A T^T p T below it
//
// A loop of four moving bodies, joints j1 .. j4. A node of S is a joint, and each is coupled with the next by the body
// that they share:
//
//   j1 -- b1 -- j2          S   j1  j2  j3  j4          factor   j1  j2  j3  j4
//   |           |           j1   x                      j1        D
//   b4          b2          j2   x   x                  j2        L   D
//   |           |           j3       x   x              j3            L   D
//   j4 -- b3 -- j3          j4   x       x   x          j4        L  fill L   D
//
// j1 goes first, and its later neighbours j2 and j4 become coupled. A loop of n joints makes n - 3 such blocks; a tree,
// and a loop that the ground closes, make none.
//
// Pivot k, later neighbours s >= t:   L_s = ((A_s T^T) p) T,   A_st -= A_s L_t^T   (target (s, t) of the plan)
// Solution:   forward  x_s -= L_s x_k,   backward  x_k <- T^T (p (T x_k)) - sum_s L_s^T x_s
//
// The inverse itself is not formed. Where a row is redundant its pivot is a proximal term, 1e-9, and the inverse has
// entries of 1e9. A_s times them is of the order of 1 only because A_s times the redundant direction, a column of
// A_s T^T, is 1e-9: that sum is formed first, and its rounding, 1e-16, stays in that direction. Multiplied by the inverse
// each term would be rounded by itself, and leave 1e-7 in later blocks, whose own redundant pivots are 1e-9.
//
// With hubs the matrix is [[-M, -J^T], [-J, S]] over (a of the hubs, lambda), quasi-definite in any order
// (Vanderbei 1995). No allocation, no search.
//
// A column of a block is one pack: all rows of a node in one instruction. Columns of m rows are ld = pack_size(m) numbers
// apart, so that row i of column k is number k ld + i. A block below a pivot has a column for each row of the pivot; a
// diagonal one becomes T below its diagonal and T^T above it.
//
// M: the unknowns of a node, a constant. X: the geometry, Spatial or Planar. Everything is always inlined, so that it is
// compiled for the instruction set of the pass that calls it (schur_passes.cpp).
#pragma once

#include <cstring>

#include "framework/dynamics/solvers/schur_plan.h"
#include "framework/foundation/math/for_size.h"

namespace lockstep::schur {

/// Space: v and w have three components. I: where the inertia's xx xy xz yy yz zz are, after the mass. a, mass: strides
/// of a slot's accelerations and masses.
struct Spatial {
  static constexpr int nv = 3, nw = 3, n = 6, a = 6, mass = 8;
  static constexpr int I[3][3] = {{1, 2, 3}, {2, 4, 5}, {3, 5, 6}};
};
/// A plane: v has two components, w one.
struct Planar {
  static constexpr int nv = 2, nw = 1, n = 3, a = 4, mass = 2;
  static constexpr int I[1][1] = {{1}};
};

/// Arrays of the numeric phase. By node (offset Node::x): x, c, scale, diagonal, p, E, r. By slot (strides of
/// X): a; mass: m, J; inverse: 1/m, J^-1, zero where nothing turns.
struct Numbers {
  const double *rows = nullptr, *inverse = nullptr, *mass = nullptr;
  double *A = nullptr, *Y = nullptr, *a = nullptr;
  double *x = nullptr, *c = nullptr, *scale = nullptr, *diagonal = nullptr, *p = nullptr, *E = nullptr, *r = nullptr;
  const double* floors = nullptr;  ///< residual floors: no scale of a row of that kind is smaller; one per RowKind
  const double* kind = nullptr;    ///< by node, a pack per RowKind with ones where a row is of that kind
  double eps = 0;                  ///< of the proximal term; 0: none
};

inline constexpr double kPivotFloor = 1e-14;  ///< relative to the diagonal before elimination

/// The n numbers at p.
template <int n>
LOCKSTEP_INLINE Pack<n>& pack(double* p) {
  return *reinterpret_cast<Pack<n>*>(p);
}
template <int n>
LOCKSTEP_INLINE const Pack<n>& pack(const double* p) {
  return *reinterpret_cast<const Pack<n>*>(p);
}
/// Ones in rows first .. last - 1, zeros elsewhere.
template <int n>
LOCKSTEP_INLINE Pack<n> ones(int first, int last) {
  Pack<n> v{};
  for (int i = first; i < last; ++i) v[i] = 1.0;
  return v;
}
/// Numbers first .. last - 1 of the n at p, which need not be aligned; zeros elsewhere.
template <int n>
LOCKSTEP_INLINE Pack<n> numbers(const double* p, int first, int last) {
  Pack<n> v;
  std::memcpy(&v, p, sizeof v);
  return v * ones<n>(first, last);
}
/// Calls f(ld) with the length of a column of m rows as a constant.
template <class F>
LOCKSTEP_INLINE void with_column(int m, F&& f) {
  using std::integral_constant;
  m <= 2 ? f(integral_constant<int, 2>{}) : m <= 4 ? f(integral_constant<int, 4>{}) : f(integral_constant<int, 8>{});
}
template <class T>
LOCKSTEP_INLINE T size_of(const T& v) {
  return v < 0.0 ? -v : v;
}
template <class T>
LOCKSTEP_INLINE T larger(const T& a, const T& b) {
  return a > b ? a : b;
}

// ------------------------------------------------------------------------------------------------- S -> factor

/// D = T^-1 diag(1/p) T^-T, symmetric positive definite, without pivoting. D <- T, T^T. `sign`: of p.
/// Step k, before: T[0..k), with T^T above, and what is left of D.
/// Column j > k, row i > k: D_ij - p D_ik D_jk;   row k: T_jk = -p D_jk;   rows i < k: T_ji - p T_ki D_jk.
/// Columns j < k have the last from row k + 1 on. Both u c: c = D_jk or T_kj, u = p column k with p in row k.
template <int M, int ld = pack_size(M)>
LOCKSTEP_INLINE void factor_block(Pack<ld>* D, const double* diagonal, double sign, double* p) {
  // Else k is not a constant, D lives on the stack, and a factor takes three times as long.
#pragma GCC unroll 8
  for (int k = 0; k < M; ++k) {
    const Pack<ld> c = D[k];
    const double d = c[k], p_k = 1.0 / larger(d, kPivotFloor * diagonal[k]);
    p[k] = sign * p_k;
    Pack<ld> u = c * p_k;
    const Pack<ld> u_below = u * ones<ld>(k + 1, ld);
    u[k] = p_k;
    for (int j = 0; j < k; ++j) D[j] -= u_below * c[j];
    for (int j = k + 1; j < M; ++j) {
      Pack<ld> D_j = D[j];
      D_j[k] = 0.0;
      D[j] = D_j - u * c[j];
    }
    D[k] = c * ones<ld>(0, k) - u_below;
  }
}

/// The block of one later node s, of columns of n: L_s = ((A_s T^T) p) T, and A_st -= A_s L_t^T with the blocks t before.
template <int M, int n>
LOCKSTEP_INLINE void eliminate_below(const Node& node, const Later* later, int s, const std::size_t* target,
                                     const Numbers& z) {
  constexpr int ld = pack_size(M);
  const double *T = z.A + node.D, *p = z.p + node.x;  // T from memory: the load broadcasts a number to a pack
  double* A_s = z.A + later[s].block;
  Pack<n> A[M], L[M];
  for (int k = 0; k < M; ++k) L[k] = A[k] = pack<n>(A_s + k * n);
  for (int j = M - 1; j >= 0; --j)
    for (int k = 0; k < j; ++k) L[j] += L[k] * T[j * ld + k];
  for (int j = 0; j < M; ++j) {
    L[j] *= p[j];
    for (int k = 0; k < j; ++k) L[k] += L[j] * T[j * ld + k];
  }
  for (int j = 0; j < M; ++j) pack<n>(A_s + j * n) = L[j];
  for (int t = 0; t <= s; ++t) {
    const double* L_t = z.A + later[t].block;
    double* A_st = z.A + target[t];
    const auto subtract = [&](int m) __attribute__((always_inline)) {
      for (int j = 0; j < m; ++j) {
        Pack<n> v = pack<n>(A_st + j * n);
        for (int k = 0; k < M; ++k) v -= A[k] * L_t[k * pack_size(m) + j];
        pack<n>(A_st + j * n) = v;
      }
    };
    later[t].m == M ? subtract(M) : subtract(later[t].m);
  }
}

/// Eliminates one pivot: factors its block, forms L below it, subtracts the products from the later blocks.
template <int M, int ld = pack_size(M)>
LOCKSTEP_INLINE void eliminate(const Plan& plan, const Node& node, const Numbers& z) {
  const double sign = node.link < 0 ? -1.0 : 1.0;  // the block of a hub is negative definite
  double* block = z.A + node.D;
  Pack<ld> D[M];
  for (int k = 0; k < M; ++k) D[k] = pack<ld>(block + k * ld) * sign;
  factor_block<M>(D, z.diagonal + node.x, sign, z.p + node.x);
  for (int k = 0; k < M; ++k) pack<ld>(block + k * ld) = D[k];
  const Later* later = plan.later.data() + node.first_later;
  const std::size_t* target = plan.targets.data() + node.first_target;
  for (int s = 0; s < node.n_later; target += ++s)
    with_column(
        later[s].m, [&](auto n) __attribute__((always_inline)) { eliminate_below<M, n>(node, later, s, target, z); });
}

/// x_s -= L_s x
template <int M>
LOCKSTEP_INLINE void forward(const Plan& plan, const Node& node, const Numbers& z) {
  const double* x = z.x + node.x;
  for (const Later& later : plan.later_of(node))
    with_column(
        later.m, [&](auto n) __attribute__((always_inline)) {
          const double* L = z.A + later.block;
          Pack<n> b = pack<n>(z.x + later.x);
          for (int k = 0; k < M; ++k) b -= pack<n>(L + k * n) * x[k];
          pack<n>(z.x + later.x) = b;
        });
}
/// x <- T^T p T x - sum L_s^T x_s
template <int M, int ld = pack_size(M)>
LOCKSTEP_INLINE void backward(const Plan& plan, const Node& node, const Numbers& z) {
  const double* T = z.A + node.D;
  const Pack<ld> x = pack<ld>(z.x + node.x);
  Pack<ld> y = x;
#pragma GCC unroll 8
  for (int k = 0; k + 1 < M; ++k) y += pack<ld>(T + k * ld) * ones<ld>(k + 1, ld) * x[k];
  const Pack<ld> v = y *= pack<ld>(z.p + node.x);
#pragma GCC unroll 8
  for (int k = 1; k < M; ++k) y += pack<ld>(T + k * ld) * ones<ld>(0, k) * v[k];
  for (const Later& later : plan.later_of(node)) {
    const double *L = z.A + later.block, *x_s = z.x + later.x;
    const auto subtract = [&](int m) __attribute__((always_inline)) {
      for (int k = 0; k < M; ++k) {
        double t = 0;
        for (int i = 0; i < m; ++i) t += L[k * pack_size(m) + i] * x_s[i];
        y[k] -= t;
      }
    };
    later.m == M ? subtract(M) : subtract(later.m);
  }
  pack<ld>(z.x + node.x) = y;
}

}  // namespace lockstep::schur
