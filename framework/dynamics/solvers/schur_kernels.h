// The numeric half of the solver `schur`, node by node. Letters as in framework/docs/solvers.md, section 2:
//
//   S = J M^-1 J^T + E,  Y = J M^-1,  D the inverse of a pivot's block,  L = A D below it.
//
// With hubs the matrix is [[-M, -J^T], [-J, S]] over (a of the hubs, lambda), quasi-definite in any order
// (Vanderbei 1995). A column of a block is one pack: all rows of a link in one instruction. No allocation, no search.
#pragma once

#include <cmath>
#include <cstring>

#include "framework/dynamics/solvers/schur_plan.h"
#include "framework/foundation/math/pack.h"

namespace lockstep::schur {

/// Space: v and w have three numbers; inverse inertia xx xy xz yy yz zz.
struct Spatial {
  static constexpr int nv = 3, nw = 3, a = 6, inverse = 8;
  static constexpr int I[3][3] = {{1, 2, 3}, {2, 4, 5}, {3, 5, 6}};
};
/// A plane: two and one.
struct Planar {
  static constexpr int nv = 2, nw = 1, a = 4, inverse = 2;
  static constexpr int I[1][1] = {{1}};
};

/// Arrays of the numeric phase. By node (offset Node::x): x, c, scale, diagonal, pivot, E, r. By slot: a, 6 (a plane:
/// 4); inverse, 8 (2): 1/m, then J^-1; mass, 10: m, J (row after row), for hubs.
struct Numbers {
  const double* rows = nullptr;
  const double *inverse = nullptr, *mass = nullptr;
  double *A = nullptr, *Y = nullptr;
  double *x = nullptr, *c = nullptr, *scale = nullptr, *diagonal = nullptr, *pivot = nullptr, *E = nullptr,
         *r = nullptr, *a = nullptr;
  const double* kind = nullptr;  ///< by node, three packs each: ones where a row is a translation, rotation, function
  double floors[3] = {0, 0, 0};  ///< no scale of a row of that kind is smaller
  double eps = 0;
};

inline constexpr double kPivotFloor = 1e-14;  ///< of the diagonal it started from

#define LOCKSTEP_KERNEL [[gnu::always_inline]] inline

template <int N>
LOCKSTEP_KERNEL Pack<N> load(const double* p) {
  return *reinterpret_cast<const Pack<N>*>(p);
}
template <int N>
LOCKSTEP_KERNEL void store(double* p, const Pack<N>& v) {
  *reinterpret_cast<Pack<N>*>(p) = v;
}
template <int N>
LOCKSTEP_KERNEL Pack<N> load_anywhere(const double* p) {
  Pack<N> v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
/// Ones in the places first ... last - 1.
template <int N>
LOCKSTEP_KERNEL Pack<N> ones(int first, int last) {
  Pack<N> v{};
  for (int i = first; i < last; ++i) v[i] = 1.0;
  return v;
}

// ------------------------------------------------------------------------------------------------- rows -> S

/// Diagonal of J M^-1 J^T over the hubs that a link touches: not in its block, but part of its scale.
template <class X, int M, bool kTriple>
void add_hub_diagonal(const Plan& plan, const Node& node, const Numbers& z, double* diagonal) {
  constexpr int ld = pack_size(M);
  for (int s = 0; s < node.n_sides; ++s) {
    const Side& side = plan.sides[static_cast<std::size_t>(node.first_side + s)];
    if (!side.hub) continue;
    const double *J = z.rows + side.J, *I = z.inverse + X::inverse * side.slot;
    for (int i = 0; i < M; ++i) {
      if (kTriple && i < X::nv) diagonal[i] += I[0];
      for (int c = 0; !kTriple && c < X::nv; ++c) diagonal[i] += I[0] * J[c * ld + i] * J[c * ld + i];
      const double* w = J + (kTriple ? 0 : X::nv * ld);
      for (int c = 0; c < X::nw; ++c)
        for (int k = 0; k < X::nw; ++k) diagonal[i] += w[c * ld + i] * I[X::I[c][k]] * w[k * ld + i];
    }
  }
}

/// Y = J M^-1 of one link and its own block of S.
template <class X, int M, bool kTriple>
LOCKSTEP_KERNEL void fill_own(const Plan& plan, const Node& node, const Numbers& z) {
  constexpr int ld = pack_size(M);
  using V = Pack<ld>;
  V D[M];
  for (int i = 0; i < M; ++i) D[i] = V{};
  double linear = 0;
  for (int s = 0; s < node.n_sides; ++s) {
    const Side& side = plan.sides[static_cast<std::size_t>(node.first_side + s)];
    const bool own = !side.hub;  // a hub has columns of its own instead
    const double* J = z.rows + side.J;
    double* Y = z.Y + side.Y;
    const double* I = z.inverse + X::inverse * side.slot;
    if constexpr (!kTriple) {
      for (int c = 0; c < X::nv; ++c) {
        const V Yc = load<ld>(J + c * ld) * I[0];
        store<ld>(Y + c * ld, Yc);
        for (int i = 0; own && i < M; ++i) D[i] += Yc * J[c * ld + i];
      }
      J += X::nv * ld, Y += X::nv * ld;
    }
    for (int c = 0; c < X::nw; ++c) {
      V Yc = load<ld>(J) * I[X::I[c][0]];
      for (int k = 1; k < X::nw; ++k) Yc += load<ld>(J + k * ld) * I[X::I[c][k]];
      store<ld>(Y + c * ld, Yc);
      for (int i = 0; own && i < M; ++i) D[i] += Yc * J[c * ld + i];
    }
    if (own) linear += I[0];
  }
  double* d = z.A + node.D;
  for (int i = 0; i < M; ++i) store<ld>(d + i * ld, D[i]);
  if constexpr (kTriple)
    for (int i = 0; i < X::nv; ++i) d[i * ld + i] += linear;

  double* diagonal = z.diagonal + node.x;
  for (int i = 0; i < M; ++i) diagonal[i] = d[i * ld + i];
  if (node.on_hub) add_hub_diagonal<X, M, kTriple>(plan, node, z, diagonal);
  if (z.eps == 0) return;
  // E = eps s_j: one number for the force rows of a link, one for its moment rows, a function's own
  double t = 0, r = 0;
  for (int i = 0; i < M; ++i) {
    t += (node.translations >> i & 1u) ? diagonal[i] : 0.0;
    r += (node.rotations >> i & 1u) ? diagonal[i] : 0.0;
  }
  t /= std::max(1, __builtin_popcount(node.translations));
  r /= std::max(1, __builtin_popcount(node.rotations));
  for (int i = 0; i < M; ++i) {
    const double s = (node.translations >> i & 1u) ? t : (node.rotations >> i & 1u) ? r : diagonal[i];
    const double e = z.eps * (s > 0 ? s : 1.0);
    z.E[node.x + static_cast<std::size_t>(i)] = e;
    d[i * ld + i] += e;
    diagonal[i] += e;
  }
}

/// Share of a slot in the block between two links of one size, both turned: J_later M^-1 J_pivot^T.
template <class X, int M>
LOCKSTEP_KERNEL void fill_term(const Side& p, const Side& q, const Numbers& z, double* block) {
  constexpr int ld = pack_size(M);
  using V = Pack<ld>;
  const double *Y = z.Y + p.Y, *J = z.rows + q.J;
  V Jc[X::nw];
  for (int c = 0; c < X::nw; ++c) Jc[c] = load<ld>(J + c * ld);
  for (int i = 0; i < M; ++i) {
    V a = load<ld>(block + i * ld);
    for (int c = 0; c < X::nw; ++c) a += Jc[c] * Y[c * ld + i];
    store<ld>(block + i * ld, a);
  }
  const double k = p.sign * q.sign * z.inverse[X::inverse * p.slot];
  for (int c = 0; c < X::nv; ++c) block[c * ld + c] += k;
}

/// The same for any two links, number by number.
template <class X>
LOCKSTEP_KERNEL void fill_any_term(const Node& pivot, const Side& p, bool p_turned, const Node& later, const Side& q,
                                   bool q_turned, const Numbers& z, double* block) {
  const int ld = pivot.ld(), lq = later.ld();
  const double *Y = z.Y + p.Y, *J = z.rows + q.J, m = z.inverse[X::inverse * p.slot];
  const double *Yw = Y + (p_turned ? 0 : X::nv * ld), *Jw = J + (q_turned ? 0 : X::nv * lq);
  for (int i = 0; i < pivot.m; ++i)
    for (int j = 0; j < later.m; ++j) {
      double s = 0;
      for (int c = 0; c < X::nw; ++c) s += Jw[c * lq + j] * Yw[c * ld + i];
      for (int c = 0; c < X::nv; ++c) {
        const double y = p_turned ? (c == i ? p.sign * m : 0.0) : Y[c * ld + i];
        s += y * (q_turned ? (c == j ? q.sign : 0.0) : J[c * lq + j]);
      }
      block[i * lq + j] += s;
    }
}

// ------------------------------------------------------------------------------------------------- S -> factor

/// D <- D^-1, symmetric positive definite, by sweeps without pivoting.
template <int M>
LOCKSTEP_KERNEL void invert(Pack<pack_size(M)>* D, const double* diagonal, double* pivot) {
  using V = Pack<pack_size(M)>;
  for (int k = 0; k < M; ++k) {
    const V column = D[k];
    const double floor = kPivotFloor * diagonal[k];
    const double d = column[k] > floor ? column[k] : floor;
    pivot[k] = d;
    const double p = 1.0 / d;
    V u = column * p;
    u[k] = -p;
    for (int j = 0; j < M; ++j) {
      if (j == k) continue;
      V Dj = D[j];
      Dj[k] = 0.0;
      D[j] = Dj - u * column[j];
    }
    D[k] = u;
  }
  for (int k = 0; k < M; ++k) D[k] = -D[k];
}

/// The block of one later node: L = A D, and all products with the blocks before it.
template <int M, int kPack>
LOCKSTEP_KERNEL void eliminate_below(const Node& node, const Later* later, int s, const std::size_t* target,
                                     const Numbers& z) {
  constexpr int ld = pack_size(M);
  using V = Pack<kPack>;
  const double* D = z.A + node.D;
  double* As = z.A + later[s].block;
  V A[M], L[M];
  for (int k = 0; k < M; ++k) A[k] = load<kPack>(As + k * kPack);
  for (int j = 0; j < M; ++j) {
    V l = A[0] * D[j];
    for (int k = 1; k < M; ++k) l += A[k] * D[k * ld + j];
    L[j] = l;
  }
  for (int j = 0; j < M; ++j) store<kPack>(As + j * kPack, L[j]);
  const auto subtract = [&](double* T, const double* Lt, int lt, int mt) __attribute__((always_inline)) {
    for (int i = 0; i < mt; ++i) {
      V t = load<kPack>(T + i * kPack);
      for (int k = 0; k < M; ++k) t -= A[k] * Lt[k * lt + i];
      store<kPack>(T + i * kPack, t);
    }
  };
  for (int t = 0; t <= s; ++t) {
    const Later& other = later[t];
    if (other.m == M)
      subtract(z.A + target[t], z.A + other.block, ld, M);
    else
      subtract(z.A + target[t], z.A + other.block, pack_size(other.m), other.m);
  }
}

template <int M>
LOCKSTEP_KERNEL void eliminate(const Plan& plan, const Node& node, const Numbers& z) {
  constexpr int ld = pack_size(M);
  Pack<ld> D[M];
  double* d = z.A + node.D;
  const double sign = node.link < 0 ? -1.0 : 1.0;  // the block of a hub is negative definite
  for (int k = 0; k < M; ++k) D[k] = load<ld>(d + k * ld) * sign;
  invert<M>(D, z.diagonal + node.x, z.pivot + node.x);
  for (int k = 0; k < M; ++k) store<ld>(d + k * ld, D[k] * sign);
  const Later* later = plan.later.data() + node.first_later;
  const std::size_t* target = plan.targets.data() + node.first_target;
  for (int s = 0; s < node.n_later; target += ++s) {
    switch (pack_size(later[s].m)) {
      case 2:
        eliminate_below<M, 2>(node, later, s, target, z);
        break;
      case 4:
        eliminate_below<M, 4>(node, later, s, target, z);
        break;
      default:
        eliminate_below<M, 8>(node, later, s, target, z);
    }
  }
}

/// x_later -= L x
template <int M, int kPack>
LOCKSTEP_KERNEL void forward_below(const Later& later, const double* x, const Numbers& z) {
  const double* L = z.A + later.block;
  auto b = load<kPack>(z.x + later.x);
  for (int k = 0; k < M; ++k) b -= load<kPack>(L + k * kPack) * x[k];
  store<kPack>(z.x + later.x, b);
}
template <int M>
LOCKSTEP_KERNEL void forward(const Plan& plan, const Node& node, const Numbers& z) {
  const double* x = z.x + node.x;
  for (int s = 0; s < node.n_later; ++s) {
    const Later& later = plan.later[static_cast<std::size_t>(node.first_later + s)];
    switch (pack_size(later.m)) {
      case 2:
        forward_below<M, 2>(later, x, z);
        break;
      case 4:
        forward_below<M, 4>(later, x, z);
        break;
      default:
        forward_below<M, 8>(later, x, z);
    }
  }
}
/// x <- D x - sum L^T x_later
template <int M>
LOCKSTEP_KERNEL void backward(const Plan& plan, const Node& node, const Numbers& z) {
  constexpr int ld = pack_size(M);
  double* x = z.x + node.x;
  const double* D = z.A + node.D;
  Pack<ld> y = load<ld>(D) * x[0];
  for (int k = 1; k < M; ++k) y += load<ld>(D + k * ld) * x[k];
  for (int s = 0; s < node.n_later; ++s) {
    const Later& later = plan.later[static_cast<std::size_t>(node.first_later + s)];
    const double *L = z.A + later.block, *xs = z.x + later.x;
    const int ls = pack_size(later.m);
    for (int k = 0; k < M; ++k) {
      double t = 0;
      if (later.m == M)
        for (int i = 0; i < M; ++i) t += L[k * ld + i] * xs[i];
      else
        for (int i = 0; i < later.m; ++i) t += L[k * ls + i] * xs[i];
      y[k] -= t;
    }
  }
  store<ld>(x, y);
}

// ------------------------------------------------------------------------------------------------- right sides

/// J a of one link, in the axes that its rows are kept in.
template <class X, int M, bool kTriple>
LOCKSTEP_KERNEL Pack<pack_size(M)> rows_times(const Side& side, const Numbers& z) {
  constexpr int ld = pack_size(M);
  const double *J = z.rows + side.J, *a = z.a + X::a * side.slot;
  if constexpr (kTriple) {
    auto b = load_anywhere<ld>(a) * ones<ld>(0, X::nv) * side.sign;
    for (int c = 0; c < X::nw; ++c) b += load<ld>(J + c * ld) * a[X::nv + c];
    return b;
  } else {
    auto b = load<ld>(J) * a[0];
    for (int c = 1; c < X::nv + X::nw; ++c) b += load<ld>(J + c * ld) * a[c];
    return b;
  }
}

/// x = J a_f - c of one link, c turned into the rows' axes, and the scales |J a_f| + |c|. c: numbers of its rows.
template <class X, int M, bool kTriple>
LOCKSTEP_KERNEL void start_link(const Plan& plan, const Node& node, const double* given, const Numbers& z) {
  constexpr int ld = pack_size(M);
  using V = Pack<ld>;
  V b{}, on_hubs{};
  for (int s = 0; s < node.n_sides; ++s) {
    const Side& side = plan.sides[static_cast<std::size_t>(node.first_side + s)];
    (side.hub ? on_hubs : b) += rows_times<X, M, kTriple>(side, z);
  }
  V c = load_anywhere<ld>(given) * ones<ld>(kTriple ? X::nv : 0, M);
  if constexpr (kTriple) {
    const double* R = z.rows + node.R;
    for (int k = 0; k < X::nv; ++k) c += load<ld>(R + k * ld) * given[k];
  }
  store<ld>(z.c + node.x, c);
  store<ld>(z.x + node.x, b - c);
  const V all = b + on_hubs;
  for (int i = 0; i < M; ++i) z.scale[node.x + static_cast<std::size_t>(i)] = std::abs(all[i]) + std::abs(c[i]);
}

/// a -= Y^T x
template <class X, int M, bool kTriple>
LOCKSTEP_KERNEL void apply_link(const Plan& plan, const Node& node, const double* x, const Numbers& z) {
  constexpr int ld = pack_size(M);
  for (int s = 0; s < node.n_sides; ++s) {
    const Side& side = plan.sides[static_cast<std::size_t>(node.first_side + s)];
    const double* Y = z.Y + side.Y;
    double* a = z.a + X::a * side.slot;
    constexpr int n = kTriple ? X::nw : X::nv + X::nw, first = kTriple ? X::nv : 0;
    if constexpr (kTriple) {
      const double k = side.sign * z.inverse[X::inverse * side.slot];
      for (int c = 0; c < X::nv; ++c) a[c] -= k * x[c];
    }
    for (int c = 0; c < n; ++c) {
      double t = 0;
      for (int i = 0; i < M; ++i) t += Y[c * ld + i] * x[i];
      a[first + c] -= t;
    }
  }
}

/// r = J a - c
template <class X, int M, bool kTriple>
LOCKSTEP_KERNEL void residual_link(const Plan& plan, const Node& node, const Numbers& z) {
  constexpr int ld = pack_size(M);
  Pack<ld> r = -load<ld>(z.c + node.x);
  for (int s = 0; s < node.n_sides; ++s)
    r += rows_times<X, M, kTriple>(plan.sides[static_cast<std::size_t>(node.first_side + s)], z);
  store<ld>(z.r + node.x, r);
}

/// Whether |r| is within `tolerance` of the row's scale, in all rows of a node.
template <int M>
LOCKSTEP_KERNEL bool within_link(const Node& node, double tolerance, const Numbers& z) {
  constexpr int ld = pack_size(M);
  using V = Pack<ld>;
  const double* kind = z.kind + 3 * node.x;
  const V floor =
      load<ld>(kind) * z.floors[0] + load<ld>(kind + ld) * z.floors[1] + load<ld>(kind + 2 * ld) * z.floors[2];
  const V scale = load<ld>(z.scale + node.x), r = load<ld>(z.r + node.x);
  const V limit = tolerance * (scale > floor ? scale : floor), size = r < 0.0 ? -r : r;
  const auto over = size > limit;  // a NaN is not: the caller looks at the accelerations
  bool any = false;
  for (int i = 0; i < M; ++i) any = any || over[i];
  return !any;
}

#undef LOCKSTEP_KERNEL

}  // namespace lockstep::schur
