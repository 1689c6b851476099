// The elimination of S = J M^-1 J^T + E over the graph of the links, node by node (framework/docs/solvers.md, sections 2 and 5): the
// numeric half, one text for one matrix and for several matrices at once, one per vector lane. Letters:
//
//   Y = J M^-1,   D the inverse of a pivot's block,   L = A D below it
//
// A loop of four moving bodies, joints j1 .. j4. A node of S is a joint, and each is coupled with the next by the body that
// they share:
//
//   j1 -- b1 -- j2          S   j1  j2  j3  j4          factor   j1  j2  j3  j4
//   |           |           j1   x                      j1        D
//   b4          b2          j2   x   x                  j2        L   D
//   |           |           j3       x   x              j3            L   D
//   j4 -- b3 -- j3          j4   x       x   x          j4        L  fill L   D
//
// j1 goes first, and its later neighbours j2 and j4 become coupled. A loop of n joints makes n - 3 such blocks; a tree, and a
// loop that the ground closes, make none.
//
// Pivot k, later neighbours s >= t:   L_s = A_s D_k,   A_st -= A_s L_t^T   (target (s, t) of the plan; s = t: D_s)
// Solution:   forward  x_s -= L_s x_k,   backward  x_k <- D_k x_k - sum_s L_s^T x_s
//
// With hubs the matrix is [[-M, -J^T], [-J, S]] over (a of the hubs, lambda), quasi-definite in any order
// (Vanderbei 1995). No allocation, no search.
//
// K is the storage (schur_plan.h): PackedBlocks (schur_blocks.h), or the blocks of the lanes (tools/batch/lane_blocks.h):
//   K::Number             a double, or a pack of them, one per lane
//   K::Slab<m>            rows of a column of m that one register holds, K::slabs(m) of them: all rows, or one per lane
//   K::at(p, i)           address of number i; K::number, K::put, K::load<Slab>, K::store: read and write there
//   K::stride(m)          numbers from one column of J, Y to the next
//   K::below(i, k, m, n)  place of row i, column k in a block of m x n below a pivot; K::square(i, k, m): in a diagonal one
//   K::columns(i, m)      columns that a diagonal block keeps of slab i
//   K::row, set_row, add_row   row k of a column in slabs
//   K::Square<M>          a diagonal block in registers
//   K::floor, K::mark     residual floors of a slab; what a test says of its rows
// X is the geometry, Spatial or Planar. Everything is always inlined, so that it is compiled for the instruction set of
// the pass that calls it.
#pragma once

#include <cmath>
#include <cstring>

#include "framework/dynamics/solvers/scales.h"
#include "framework/dynamics/solvers/schur_plan.h"
#include "framework/foundation/math/for_size.h"

namespace lockstep::schur {

/// Space: v and w have three numbers. I: where the inertia's numbers are, xx xy xz yy yz zz behind the mass; strides of
/// the accelerations and masses of a slot.
struct Spatial {
  static constexpr int nv = 3, nw = 3, n = 6, a = 6, mass = 8;
  static constexpr int I[3][3] = {{1, 2, 3}, {2, 4, 5}, {3, 5, 6}};
};
/// A plane: two and one.
struct Planar {
  static constexpr int nv = 2, nw = 1, n = 3, a = 4, mass = 2;
  static constexpr int I[1][1] = {{1}};
};

/// Arrays of the numeric phase. By node (offset Node::x): x, c, scale, diagonal, pivot, E, r, lambda. By slot (strides
/// of X): a; mass: m, J; inverse: 1/m, J^-1, zero where nothing turns.
struct Numbers {
  const double *rows = nullptr, *inverse = nullptr, *mass = nullptr;
  double *A = nullptr, *Y = nullptr, *a = nullptr;
  double *x = nullptr, *c = nullptr, *scale = nullptr, *diagonal = nullptr, *pivot = nullptr, *E = nullptr,
         *r = nullptr, *lambda = nullptr;
  const double* floors = nullptr;  ///< residual floors: no scale of a row of that kind is smaller; one per RowKind
  const double* kind = nullptr;    ///< packed: by node, a pack per RowKind with ones where a row is of that kind
  double eps = 0;                  ///< of the proximal term; 0: none
};

inline constexpr double kProximal = 1e-9;     ///< eps of loops; trees have none
inline constexpr double kPivotFloor = 1e-14;  ///< of the diagonal it started from

#define LOCKSTEP_KERNEL [[gnu::always_inline]] inline

template <class T>
LOCKSTEP_KERNEL T size_of(const T& v) {
  return v < 0.0 ? -v : v;
}
template <class T>
LOCKSTEP_KERNEL T larger(const T& a, const T& b) {
  return a > b ? a : b;
}

// ------------------------------------------------------------------------------------------------- masses

/// J^-1 t of one slot, I its inverse mass; J w with the mass itself.
template <class K, class X>
LOCKSTEP_KERNEL void inertia_times(const double* I, const typename K::Number* t, typename K::Number* out) {
  for (int i = 0; i < X::nw; ++i) {
    out[i] = K::number(I, X::I[i][0]) * t[0];
    for (int k = 1; k < X::nw; ++k) out[i] += K::number(I, X::I[i][k]) * t[k];
  }
}
/// a = M^-1 f; f = M a with the mass itself.
template <class K, class X>
LOCKSTEP_KERNEL void mass_times(const double* I, const typename K::Number* f, typename K::Number* a) {
  for (int i = 0; i < X::nv; ++i) a[i] = K::number(I, 0) * f[i];
  inertia_times<K, X>(I, f + X::nv, a + X::nv);
}
template <class K, class X>
LOCKSTEP_KERNEL typename K::Number power(const typename K::Number* f, const typename K::Number* a) {
  auto sum = f[0] * a[0];
  for (int i = 1; i < X::n; ++i) sum += f[i] * a[i];
  return sum;
}
/// The largest a . M a of a slot.
template <class K, class X>
LOCKSTEP_KERNEL typename K::Number largest_energy(const Plan& plan, const Numbers& z, const double* accelerations) {
  typename K::Number most{}, a[X::n], f[X::n];
  for (int s = 0; s < plan.n_slots; ++s) {
    for (int i = 0; i < X::n; ++i) a[i] = K::number(accelerations, X::a * s + i);
    mass_times<K, X>(K::at(z.mass, X::mass * s), a, f);
    most = larger(power<K, X>(f, a), most);
  }
  return most;
}
/// The largest value of the rows of each kind.
template <class K>
LOCKSTEP_KERNEL void largest_by_kind(const Plan& plan, const double* values, typename K::Number* largest) {
  for (int k = 0; k < 3; ++k) largest[k] = typename K::Number{};
  for (const Node& node : plan.nodes)
    for (int k = 0; node.link >= 0 && k < node.m; ++k) {
      auto& most = largest[static_cast<int>(node.kinds.of(k))];
      most = larger(K::number(values, node.x + k), most);
    }
}

// ------------------------------------------------------------------------------------------------- rows -> S

/// Diagonal of J M^-1 J^T over the hubs that a link touches: not in its block, but part of its scale.
template <class K, class X, int M, bool kTurned>
void add_hub_diagonal(const Plan& plan, const Node& node, const Numbers& z, typename K::Number* diagonal) {
  constexpr int kAngular = kTurned ? 0 : X::nv;  // first column of the angular part
  for (const Side& side : plan.sides_of(node)) {
    if (!side.hub) continue;
    const double* I = K::at(z.inverse, X::mass * side.slot);
    for (int i = 0; i < M; ++i) {
      const auto J = [&](int c) { return K::number(K::at(z.rows, side.J), c * K::stride(M) + i); };
      if (kTurned && i < X::nv) diagonal[i] += K::number(I, 0);
      for (int c = 0; c < kAngular; ++c) diagonal[i] += K::number(I, 0) * J(c) * J(c);
      for (int c = 0; c < X::nw; ++c)
        for (int k = 0; k < X::nw; ++k)
          diagonal[i] += J(kAngular + c) * K::number(I, X::I[c][k]) * J(kAngular + k);
    }
  }
}

/// E = eps s_j, added to the diagonal of S.
template <class K, int M>
LOCKSTEP_KERNEL void add_proximal(const Node& node, const Numbers& z, typename K::Number* diagonal,
                                  typename K::template Square<M>& D) {
  typename K::Number s[M];
  for (int i = 0; i < M; ++i) s[i] = diagonal[i];
  average_scales(s, M, [&](int i) __attribute__((always_inline)) { return node.kinds.of(i); });
  for (int i = 0; i < M; ++i) {
    const auto e = z.eps * s[i];
    K::put(z.E, node.x + i, e);
    D.add_to_diagonal(i, e);
    diagonal[i] += e;
  }
}

/// Y = J M^-1 of one link and its own block of S + E.
template <class K, class X, int M, bool kTurned>
LOCKSTEP_KERNEL void fill_own(const Plan& plan, const Node& node, const Numbers& z) {
  using Slab = typename K::template Slab<M>;
  constexpr int kAngular = kTurned ? 0 : X::nv;
  typename K::template Square<M> D{};
  typename K::Number linear{}, diagonal[M];
  for (const Side& side : plan.sides_of(node)) {
    const bool own = !side.hub;  // a hub has columns of its own instead
    const double *J = K::at(z.rows, side.J), *I = K::at(z.inverse, X::mass * side.slot);
    double* Y = K::at(z.Y, side.Y);
    const auto take = [&](int c, int i, const Slab& y) __attribute__((always_inline)) {
      K::store(K::at(Y, c * K::stride(M) + i), y);
      for (int j = 0; own && j < K::columns(i, M); ++j) D.slab(i, j) += y * K::number(J, c * K::stride(M) + j);
    };
    const auto Jc = [&](int c, int i) __attribute__((always_inline)) {
      return K::template load<Slab>(K::at(J, c * K::stride(M) + i));
    };
    for (int c = 0; c < kAngular; ++c)
      for (int i = 0; i < K::slabs(M); ++i) take(c, i, Jc(c, i) * K::number(I, 0));
    for (int i = 0; i < K::slabs(M); ++i)
      for (int c = 0; c < X::nw; ++c) {
        Slab y = Jc(kAngular, i) * K::number(I, X::I[c][0]);
        for (int k = 1; k < X::nw; ++k) y += Jc(kAngular + k, i) * K::number(I, X::I[c][k]);
        take(kAngular + c, i, y);
      }
    if (own) linear += K::number(I, 0);
  }
  for (int i = 0; i < M; ++i) {
    if (kTurned && i < X::nv) D.add_to_diagonal(i, linear);
    diagonal[i] = D.number(i, i);
  }
  if constexpr (K::kPacked)
    if (node.on_hub) add_hub_diagonal<K, X, M, kTurned>(plan, node, z, diagonal);
  if (z.eps > 0) add_proximal<K, M>(node, z, diagonal, D);
  for (int i = 0; i < M; ++i) K::put(z.diagonal, node.x + i, diagonal[i]);
  D.store(K::at(z.A, node.D));
}

/// Share of a slot in the block between two links of one size, both turned: J_later M^-1 J_pivot^T. `first`: the block is
/// written, not added to.
template <class K, class X, int M>
LOCKSTEP_KERNEL void fill_term(const Side& p, const Side& q, const Numbers& z, double* block, bool first) {
  using Slab = typename K::template Slab<M>;
  const double *Y = K::at(z.Y, p.Y), *J = K::at(z.rows, q.J);
  const typename K::Number linear = p.sign * q.sign * K::number(z.inverse, X::mass * p.slot);
  for (int j = 0; j < K::slabs(M); ++j) {
    Slab Jc[X::nw];
    for (int c = 0; c < X::nw; ++c) Jc[c] = K::template load<Slab>(K::at(J, c * K::stride(M) + j));
    for (int i = 0; i < M; ++i) {
      double* at = K::at(block, K::below(j, i, M, M));
      Slab a = first ? Slab{} : K::template load<Slab>(at);
      for (int c = 0; c < X::nw; ++c) a += Jc[c] * K::number(Y, c * K::stride(M) + i);
      if (i < X::nv) K::add_row(a, j, i, linear);
      K::store(at, a);
    }
  }
}

/// The same for any two links, number by number.
template <class K, class X>
LOCKSTEP_KERNEL void fill_any_term(int mp, const Side& p, int mq, const Side& q, const Numbers& z, double* block,
                                   bool first) {
  using Number = typename K::Number;
  const auto Y = [&](int c, int i) __attribute__((always_inline)) {
    return K::number(K::at(z.Y, p.Y), c * K::stride(mp) + i);
  };
  const auto J = [&](int c, int j) __attribute__((always_inline)) {
    return K::number(K::at(z.rows, q.J), c * K::stride(mq) + j);
  };
  const int first_p = p.turned ? 0 : X::nv, first_q = q.turned ? 0 : X::nv;  // columns of the angular parts
  const Number im = K::number(z.inverse, X::mass * p.slot);
  for (int i = 0; i < mp; ++i)
    for (int j = 0; j < mq; ++j) {
      Number s = J(first_q, j) * Y(first_p, i);
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
      double* at = K::at(block, K::below(j, i, mq, mp));
      K::put(at, 0, first ? s : K::number(at, 0) + s);
    }
}

// ------------------------------------------------------------------------------------------------- S -> factor

/// D <- D^-1, symmetric positive definite, by sweeps without pivoting.
template <class K, int M>
LOCKSTEP_KERNEL void invert(typename K::template Square<M>& D, const double* diagonal, double* pivot) {
  using Number = typename K::Number;
  for (int k = 0; k < M; ++k) {
    typename K::template Slab<M> u[K::slabs(M)];
    Number column[M];
    for (int j = 0; j < M; ++j) column[j] = D.number(j, k);
    const Number floor = kPivotFloor * K::number(diagonal, k), d = larger(column[k], floor), p = 1.0 / d;
    K::put(pivot, k, d);
    for (int i = 0; i < K::slabs(M); ++i) u[i] = D.slab(i, k) * p;
    K::set_row(u, k, -p);
    for (int i = 0; i < K::slabs(M); ++i)
      for (int j = 0; j < K::columns(i, M); ++j)
        if (j != k) D.sweep(i, j, k, u[i], column[j]);
    for (int i = 0; i < K::slabs(M); ++i) D.slab(i, k) = u[i];
  }
  for (int i = 0; i < K::slabs(M); ++i)
    for (int j = 0; j < K::columns(i, M); ++j) D.slab(i, j) = -D.slab(i, j);
}

/// The block of one later node, s: L = A D, and all products with the blocks before it. With kSolve also x_s -= L x.
template <class K, int M, bool kSolve, class Slab>
LOCKSTEP_KERNEL void eliminate_below(const Node& node, const typename K::template Square<M>& D, const Later* later,
                                     int s, const std::size_t* target, const Numbers& z) {
  const int ms = later[s].m;
  double* As = K::at(z.A, later[s].block);
  for (int i = 0; i < K::slabs(ms); ++i) {
    Slab A[M], L[M];
    for (int k = 0; k < M; ++k) A[k] = K::template load<Slab>(K::at(As, K::below(i, k, K::template rows<Slab>(ms), M)));
    for (int j = 0; j < M; ++j) {
      L[j] = A[0] * D.stored(K::at(z.A, node.D), 0, j);
      for (int k = 1; k < M; ++k) L[j] += A[k] * D.stored(K::at(z.A, node.D), k, j);
    }
    for (int j = 0; j < M; ++j) K::store(K::at(As, K::below(i, j, K::template rows<Slab>(ms), M)), L[j]);
    for (int t = 0; t <= s; ++t) {
      const double* Lt = K::at(z.A, later[t].block);
      double* T = K::at(z.A, target[t]);
      const auto subtract = [&](int mt) __attribute__((always_inline)) {
        for (int j = 0; j < (t == s ? K::columns(i, mt) : mt); ++j) {
          double* at = K::at(T, t == s ? K::square(i, j, K::template rows<Slab>(ms))
                                       : K::below(i, j, K::template rows<Slab>(ms), mt));
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

/// One pivot: its block inverted, L below it, the products taken from the later blocks.
template <class K, int M, bool kSolve>
LOCKSTEP_KERNEL void eliminate(const Plan& plan, const Node& node, const Numbers& z) {
  typename K::template Square<M> D;
  double* d = K::at(z.A, node.D);
  const double sign = node.link < 0 ? -1.0 : 1.0;  // the block of a hub is negative definite
  D.load(d, sign);
  invert<K, M>(D, K::at(z.diagonal, node.x), K::at(z.pivot, node.x));
  D.store(d, sign);
  const Later* later = plan.later.data() + node.first_later;
  const std::size_t* target = plan.targets.data() + node.first_target;
  for (int s = 0; s < node.n_later; target += ++s)
    K::with_slab(later[s].m, [&]<class Slab>() __attribute__((always_inline)) {
      eliminate_below<K, M, kSolve, Slab>(node, D, later, s, target, z);
    });
}

/// x_later -= L x
template <class K, int M>
LOCKSTEP_KERNEL void forward(const Plan& plan, const Node& node, const Numbers& z) {
  const double* x = K::at(z.x, node.x);
  for (const Later& later : plan.later_of(node))
    K::with_slab(later.m, [&]<class Slab>() __attribute__((always_inline)) {
      const double* L = K::at(z.A, later.block);
      for (int i = 0; i < K::slabs(later.m); ++i) {
        double* at = K::at(z.x, later.x + i);
        Slab b = K::template load<Slab>(at);
        for (int k = 0; k < M; ++k)
          b -= K::template load<Slab>(K::at(L, K::below(i, k, K::template rows<Slab>(later.m), M))) * K::number(x, k);
        K::store(at, b);
      }
    });
}
/// x <- D x - sum L^T x_later
template <class K, int M>
LOCKSTEP_KERNEL void backward(const Plan& plan, const Node& node, const Numbers& z) {
  using Slab = typename K::template Slab<M>;
  double* x = K::at(z.x, node.x);
  const double* D = K::at(z.A, node.D);
  Slab y[K::slabs(M)];
  for (int i = 0; i < K::slabs(M); ++i) {
    y[i] = K::template load<Slab>(K::at(D, K::square(i, 0, M))) * K::number(x, 0);
    for (int k = 1; k < M; ++k) y[i] += K::template load<Slab>(K::at(D, K::square(i, k, M))) * K::number(x, k);
  }
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

// ------------------------------------------------------------------------------------------------- right sides

/// t = J u of one link and slot, in the axes that its rows are kept in; u: numbers of one slot, v then w.
template <class K, class X, int M, bool kTurned>
LOCKSTEP_KERNEL void rows_times(const Side& side, const Numbers& z, const double* u, typename K::template Slab<M>* t) {
  using Slab = typename K::template Slab<M>;
  constexpr int kFirst = kTurned ? X::nv : 0;
  for (int i = 0; i < K::slabs(M); ++i) {
    const auto term = [&](int c) __attribute__((always_inline)) -> Slab {
      return K::template load<Slab>(K::at(z.rows, side.J + (c - kFirst) * K::stride(M) + i)) * K::number(u, c);
    };
    t[i] = kTurned ? K::template head<Slab, X::nv>(u, i) * side.sign : term(kFirst);
    for (int c = kTurned ? kFirst : kFirst + 1; c < X::n; ++c) t[i] += term(c);
  }
}

/// b += J u over the slots of a link, without its hubs or with them alone; u: numbers of all slots.
template <class K, class X, int M, bool kTurned>
LOCKSTEP_KERNEL void add_rows_times(const Plan& plan, const Node& node, const Numbers& z, const double* u,
                                    typename K::template Slab<M>* b) {
  for (const Side& side : plan.sides_of(node)) {
    typename K::template Slab<M> t[K::slabs(M)];
    rows_times<K, X, M, kTurned>(side, z, K::at(u, X::a * side.slot), t);
    for (int i = 0; i < K::slabs(M); ++i) b[i] += t[i];
  }
}

/// x = J a - c of one link and the scales |J a| + |c|; a on hubs is an unknown still, and counts for the scale alone.
template <class K, class X, int M, bool kTurned>
LOCKSTEP_KERNEL void start_link(const Plan& plan, const Node& node, const Numbers& z) {
  using Slab = typename K::template Slab<M>;
  Slab b[K::slabs(M)] = {}, on_hubs[K::slabs(M)] = {};
  for (const Side& side : plan.sides_of(node)) {
    Slab t[K::slabs(M)];
    rows_times<K, X, M, kTurned>(side, z, K::at(z.a, X::a * side.slot), t);
    for (int i = 0; i < K::slabs(M); ++i) (side.hub ? on_hubs : b)[i] += t[i];
  }
  for (int i = 0; i < K::slabs(M); ++i) {
    const Slab c = K::template load<Slab>(K::at(z.c, node.x + i));
    K::store(K::at(z.x, node.x + i), b[i] - c);
    K::store(K::at(z.scale, node.x + i), size_of(Slab(b[i] + on_hubs[i])) + size_of(c));
  }
}

/// a -= Y^T x
template <class K, class X, int M, bool kTurned>
LOCKSTEP_KERNEL void apply_link(const Plan& plan, const Node& node, const double* x, const Numbers& z) {
  constexpr int kFirst = kTurned ? X::nv : 0;
  for (const Side& side : plan.sides_of(node)) {
    const double* Y = K::at(z.Y, side.Y);
    double* a = K::at(z.a, X::a * side.slot);
    if constexpr (kTurned) {
      const typename K::Number k = side.sign * K::number(z.inverse, X::mass * side.slot);
      for (int c = 0; c < X::nv; ++c) K::put(a, c, K::number(a, c) - k * K::number(x, c));
    }
    for (int c = kFirst; c < X::n; ++c) {
      typename K::Number t{};
      for (int i = 0; i < M; ++i) t += K::number(Y, (c - kFirst) * K::stride(M) + i) * K::number(x, i);
      K::put(a, c, K::number(a, c) - t);
    }
  }
}

/// r = J a - c
template <class K, class X, int M, bool kTurned>
LOCKSTEP_KERNEL void residual_link(const Plan& plan, const Node& node, const Numbers& z) {
  using Slab = typename K::template Slab<M>;
  Slab r[K::slabs(M)];
  for (int i = 0; i < K::slabs(M); ++i) r[i] = -K::template load<Slab>(K::at(z.c, node.x + i));
  add_rows_times<K, X, M, kTurned>(plan, node, z, z.a, r);
  for (int i = 0; i < K::slabs(M); ++i) K::store(K::at(z.r, node.x + i), r[i]);
}

/// Marks where |r| of a row is not within `tolerance` of its scale, its floor being the least; a NaN never is.
template <class K>
LOCKSTEP_KERNEL void check_link(const Node& node, const Numbers& z, double tolerance, typename K::Marks& unmet) {
  K::with_slab(node.m, [&]<class Slab>() __attribute__((always_inline)) {
    for (int i = 0; i < K::slabs(node.m); ++i) {
      const Slab scale = K::template load<Slab>(K::at(z.scale, node.x + i)), floor = K::template floor<Slab>(z, node, i);
      const Slab limit = tolerance * larger(scale, floor);
      K::mark(unmet, size_of(K::template load<Slab>(K::at(z.r, node.x + i))), limit);
    }
  });
}

}  // namespace lockstep::schur
