// The elimination of S = J M^-1 J^T + E over the graph of the links, node by node (framework/docs/solvers.md, sections
// 2 and 5): the numeric half, the same code for one matrix and for several at once, one per vector lane. Letters:
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
// K is the storage (schur_plan.h): PackedBlocks (schur_blocks.h), or the blocks of the lanes
// (tools/batch/lane_blocks.h):
//   K::Number             a double, or a pack of them, one per lane
//   K::Slab<m>            rows of a column of m that one register holds, K::slabs(m) of them: all rows, or one per lane
//   K::at(p, i)           address of number i; K::number, K::put, K::load<Slab>, K::store: read and write there
//   K::stride(m)          numbers from one column of J, Y to the next
//   K::below(i, k, m, n)  place of row i, column k in a block of m x n below a pivot; K::square: in a diagonal one
//   K::columns(i, m)      columns that a diagonal block keeps of slab i
//   K::row, set_row, add_row   row k of a column in slabs
//   K::Square<M>          a diagonal block in registers
//   K::times_T            y <- T y, and its transpose, of a stored block
//   K::floor, K::mark     residual floors of a slab; the result of a test of its rows
// X is the geometry, Spatial or Planar. Everything is always inlined, so that it is compiled for the instruction set of
// the pass that calls it.
#pragma once

#include <cmath>
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

/// Arrays of the numeric phase. By node (offset Node::x): x, c, scale, diagonal, p, E, r, lambda. By slot (strides
/// of X): a; mass: m, J; inverse: 1/m, J^-1, zero where nothing turns.
struct Numbers {
  const double *rows = nullptr, *inverse = nullptr, *mass = nullptr;
  double *A = nullptr, *Y = nullptr, *a = nullptr;
  double *x = nullptr, *c = nullptr, *scale = nullptr, *diagonal = nullptr, *p = nullptr, *E = nullptr, *r = nullptr,
         *lambda = nullptr;
  const double* floors = nullptr;  ///< residual floors: no scale of a row of that kind is smaller; one per RowKind
  const double* kind = nullptr;    ///< packed: by node, a pack per RowKind with ones where a row is of that kind
  double eps = 0;                  ///< of the proximal term; 0: none
};

inline constexpr double kPivotFloor = 1e-14;  ///< relative to the diagonal before elimination

#define LOCKSTEP_KERNEL [[gnu::always_inline]] inline

template <class T>
LOCKSTEP_KERNEL T size_of(const T& v) {
  return v < 0.0 ? -v : v;
}
template <class T>
LOCKSTEP_KERNEL T larger(const T& a, const T& b) {
  return a > b ? a : b;
}

// ------------------------------------------------------------------------------------------------- S -> factor

/// D = T^-1 diag(1/p) T^-T, symmetric positive definite, without pivoting. D <- T. `sign`: of p.
template <class K, int M>
LOCKSTEP_KERNEL void factor_block(typename K::template Square<M>& D, const double* diagonal, double sign, double* p) {
  using Number = typename K::Number;
  // Else k is not a constant, D lives on the stack, and a factor takes three times as long.
#pragma GCC unroll 8
  for (int k = 0; k < M; ++k) {
    const Number floor = kPivotFloor * K::number(diagonal, k), d = larger(D.number(k, k), floor), p_k = 1.0 / d;
    K::put(p, k, sign * p_k);
    D.eliminate(k, p_k);
  }
}

/// The block of one later node, s: L, and all products with the blocks before it. With kSolve also x_s -= L x.
template <class K, int M, bool kSolve, class Slab>
LOCKSTEP_KERNEL void eliminate_below(const Node& node, const typename K::template Square<M>& D, const Later* later,
                                     int s, const std::size_t* target, const Numbers& z) {
  const int ms = later[s].m;
  double* As = K::at(z.A, later[s].block);
  for (int i = 0; i < K::slabs(ms); ++i) {
    Slab A[M], L[M];
    for (int k = 0; k < M; ++k)
      L[k] = A[k] = K::template load<Slab>(K::at(As, K::below(i, k, K::template rows<Slab>(ms), M)));
    for (int j = M - 1; j >= 0; --j)
      for (int k = 0; k < j; ++k) L[j] += L[k] * D.stored(K::at(z.A, node.D), j, k);
    for (int j = 0; j < M; ++j) {
      L[j] *= K::number(z.p, node.x + j);
      for (int k = 0; k < j; ++k) L[k] += L[j] * D.stored(K::at(z.A, node.D), j, k);
    }
    for (int j = 0; j < M; ++j) K::store(K::at(As, K::below(i, j, K::template rows<Slab>(ms), M)), L[j]);
    for (int t = 0; t <= s; ++t) {
      const double* Lt = K::at(z.A, later[t].block);
      double* T = K::at(z.A, target[t]);
      const auto subtract = [&](int mt) __attribute__((always_inline)) {
        for (int j = 0; j < (t == s ? K::columns(i, mt) : mt); ++j) {
          double* at = K::at(
              T, t == s ? K::square(i, j, K::template rows<Slab>(ms)) : K::below(i, j, K::template rows<Slab>(ms), mt));
          Slab v = K::template load<Slab>(at);
          for (int k = 0; k < M; ++k) v -= A[k] * K::number(Lt, K::below(j, k, mt, M));
          K::store(at, v);
        }
      };
      later[t].m == M ? subtract(M) : subtract(later[t].m);
    }
    if constexpr (kSolve) {
      double* at = K::at(z.x, later[s].x + i);
      Slab b = K::template load<Slab>(at);
      for (int k = 0; k < M; ++k) b -= L[k] * K::number(z.x, node.x + k);
      K::store(at, b);
    }
  }
}

/// Eliminates one pivot: factors its block, forms L below it, subtracts the products from the later blocks.
template <class K, int M, bool kSolve>
LOCKSTEP_KERNEL void eliminate(const Plan& plan, const Node& node, const Numbers& z) {
  typename K::template Square<M> D;
  double* d = K::at(z.A, node.D);
  const double sign = node.link < 0 ? -1.0 : 1.0;  // the block of a hub is negative definite
  D.load(d, sign);
  factor_block<K, M>(D, K::at(z.diagonal, node.x), sign, K::at(z.p, node.x));
  D.store(d);
  const Later* later = plan.later.data() + node.first_later;
  const std::size_t* target = plan.targets.data() + node.first_target;
  for (int s = 0; s < node.n_later; target += ++s)
    K::with_slab(
        later[s].m, [&]<class Slab>() __attribute__((always_inline)) {
          eliminate_below<K, M, kSolve, Slab>(node, D, later, s, target, z);
        });
}

/// x_later -= L x
template <class K, int M>
LOCKSTEP_KERNEL void forward(const Plan& plan, const Node& node, const Numbers& z) {
  const double* x = K::at(z.x, node.x);
  for (const Later& later : plan.later_of(node))
    K::with_slab(
        later.m, [&]<class Slab>() __attribute__((always_inline)) {
          const double* L = K::at(z.A, later.block);
          for (int i = 0; i < K::slabs(later.m); ++i) {
            double* at = K::at(z.x, later.x + i);
            Slab b = K::template load<Slab>(at);
            for (int k = 0; k < M; ++k)
              b -= K::template load<Slab>(K::at(L, K::below(i, k, K::template rows<Slab>(later.m), M))) *
                   K::number(x, k);
            K::store(at, b);
          }
        });
}
/// x <- T^T p T x - sum L^T x_later
template <class K, int M>
LOCKSTEP_KERNEL void backward(const Plan& plan, const Node& node, const Numbers& z) {
  using Slab = typename K::template Slab<M>;
  double *x = K::at(z.x, node.x), *p = K::at(z.p, node.x), *D = K::at(z.A, node.D);
  Slab y[K::slabs(M)];
  for (int i = 0; i < K::slabs(M); ++i) y[i] = K::template load<Slab>(K::at(x, i));
  K::template times_T<M>(D, y);
  for (int i = 0; i < K::slabs(M); ++i) y[i] *= K::template load<Slab>(K::at(p, i));
  K::template times_T_transposed<M>(D, y);
  for (const Later& later : plan.later_of(node)) {
    const double *L = K::at(z.A, later.block), *xs = K::at(z.x, later.x);
    const auto subtract = [&](int m) __attribute__((always_inline)) {
      for (int k = 0; k < M; ++k) {
        typename K::Number t{};
        for (int i = 0; i < m; ++i) t += K::number(L, K::below(i, k, m, M)) * K::number(xs, i);
        K::set_row(y, k, K::row(y, k) - t);
      }
    };
    later.m == M ? subtract(M) : subtract(later.m);
  }
  for (int i = 0; i < K::slabs(M); ++i) K::store(K::at(x, i), y[i]);
}

#undef LOCKSTEP_KERNEL

}  // namespace lockstep::schur
