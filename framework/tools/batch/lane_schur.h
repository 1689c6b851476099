// S = J M^-1 J^T + E in lanes, its factor and its solutions, node by node: dynamics/solvers/schur_kernels.h with a copy a lane.
// Private to the room.
//
// Blocks: D the lower triangle of a node, row after row; below it m_later x m_pivot, row after row. J and Y column
// after column. In a triple the v part of J is +-1 and not kept.
#pragma once

#include "framework/tools/batch/lane_math.h"
#include "framework/tools/batch/lane_numbers.h"

namespace lockstep::lanes::LOCKSTEP_SET {

inline constexpr double kPivotFloor = 1e-14;                        ///< of the diagonal it started from
inline constexpr int kI[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};  ///< xx xy xz yy yz zz

LOCKSTEP_LANE constexpr int tri(int i, int j) { return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i; }
LOCKSTEP_LANE constexpr std::size_t at(int k) { return static_cast<std::size_t>(k); }
LOCKSTEP_LANE const Side& side_of(const Plan& plan, int k) { return plan.sides[static_cast<std::size_t>(k)]; }
LOCKSTEP_LANE const double* mass_of(const Numbers& z, int k) { return z.mass + kLanes * mass::size * at(k); }

/// Y = J M^-1 and the node's own block. With kStart also c, x = J a_f - c and the scales |J a_f| + |c|.
template <int M, bool kTriple, bool kStart>
LOCKSTEP_LANE void own(const Plan& plan, const Node& node, const Numbers& z) {
  V D[M * (M + 1) / 2], b[M];
  for (V& d : D) d = V{};
  for (V& bi : b) bi = V{};
  for (int i = node.first_side; i < node.first_side + node.n_sides; ++i) {
    const Side& side = side_of(plan, i);
    const double *J = z.J + kLanes * side.J, *I = mass_of(z, side.slot), *af = z.af + kLanes * 6 * at(side.slot);
    double* Y = z.Y + kLanes * side.Y;
    const V im = load(I, mass::inverse);
    if constexpr (kTriple) {
      for (int k = 0; k < 3; ++k) {
        D[tri(k, k)] += im;
        if constexpr (kStart) b[k] += side.sign * load(af, at(k));
      }
    } else {
      for (int c = 0; c < 3; ++c) {
        V Jc[M];
        for (int k = 0; k < M; ++k) Jc[k] = load(J, at(c * M + k));
        for (int k = 0; k < M; ++k) {
          const V y = Jc[k] * im;
          store(Y, at(c * M + k), y);
          for (int j = 0; j <= k; ++j) D[tri(k, j)] += y * Jc[j];
          if constexpr (kStart) b[k] += Jc[k] * load(af, at(c));
        }
      }
      J += kLanes * 3 * M, Y += kLanes * 3 * M;
    }
    V Iw[6];
    for (int k = 0; k < 6; ++k) Iw[k] = load(I, mass::Jinv + at(k));
    for (int k = 0; k < M; ++k) {
      const V j0 = load(J, at(k)), j1 = load(J, at(M + k)), j2 = load(J, at(2 * M + k));
      const V y0 = j0 * Iw[0] + j1 * Iw[1] + j2 * Iw[2], y1 = j0 * Iw[1] + j1 * Iw[3] + j2 * Iw[4],
              y2 = j0 * Iw[2] + j1 * Iw[4] + j2 * Iw[5];
      store(Y, at(k), y0), store(Y, at(M + k), y1), store(Y, at(2 * M + k), y2);
      for (int j = 0; j <= k; ++j)
        D[tri(k, j)] += y0 * load(J, at(j)) + y1 * load(J, at(M + j)) + y2 * load(J, at(2 * M + j));
      if constexpr (kStart) b[k] += j0 * load(af, 3) + j1 * load(af, 4) + j2 * load(af, 5);
    }
  }
  if constexpr (kStart)
    for (int k = 0; k < M; ++k) {
      const V c = load(z.c, node.x + at(k));
      store(z.x, node.x + at(k), b[k] - c);
      store(z.scale, node.x + at(k), size_of(b[k]) + size_of(c));
    }
  if (z.eps > 0) {  // E = eps s_j: one number for the force rows of a link, one for its moment rows
    V t{}, r{};
    int n_t = 0, n_r = 0;
    for (int k = 0; k < M; ++k)
      node.kind[at(k)] == RowKind::translation ? (t += D[tri(k, k)], ++n_t) : (r += D[tri(k, k)], ++n_r);
    t = t / double(n_t > 0 ? n_t : 1), r = r / double(n_r > 0 ? n_r : 1);
    for (int k = 0; k < M; ++k) {
      const V s = node.kind[at(k)] == RowKind::translation ? t : r;
      const V e = z.eps * (s > 0.0 ? s : V{} + 1.0);
      D[tri(k, k)] += e;
      store(z.E, node.x + at(k), e);
    }
  }
  for (int k = 0; k < M; ++k) store(z.diagonal, node.x + at(k), D[tri(k, k)]);
  double* d = z.A + kLanes * node.D;
  for (int k = 0; k < M * (M + 1) / 2; ++k) store(d, at(k), D[k]);
}

/// Share of one slot in the block of a later node; `first`: the block is written, not added to.
template <int MP, int MQ>
LOCKSTEP_LANE void term(int mp_, int mq_, const Side& p, const Side& q, const Numbers& z, double* block, bool first) {
  const int mp = MP > 0 ? MP : mp_, mq = MQ > 0 ? MQ : mq_;
  const double *Y = z.Y + kLanes * p.Y, *J = z.J + kLanes * q.J;
  const double *Yw = Y + (p.triple ? 0 : kLanes * 3 * mp), *Jw = J + (q.triple ? 0 : kLanes * 3 * mq);
  const V im = load(mass_of(z, p.slot), mass::inverse);
  for (int j = 0; j < mq; ++j) {
    const V j0 = load(Jw, at(j)), j1 = load(Jw, at(mq + j)), j2 = load(Jw, at(2 * mq + j));
    for (int i = 0; i < mp; ++i) {
      V s = j0 * load(Yw, at(i)) + j1 * load(Yw, at(mp + i)) + j2 * load(Yw, at(2 * mp + i));
      if (p.triple && q.triple) {
        if (i == j && i < 3) s += (p.sign * q.sign) * im;
      } else if (p.triple) {
        if (i < 3) s += p.sign * im * load(J, at(i * mq + j));
      } else if (q.triple) {
        if (j < 3) s += q.sign * load(Y, at(j * mp + i));
      } else {
        for (int c = 0; c < 3; ++c) s += load(J, at(c * mq + j)) * load(Y, at(c * mp + i));
      }
      store(block, at(j * mp + i), first ? s : load(block, at(j * mp + i)) + s);
    }
  }
}

/// Blocks below one node.
template <int M>
LOCKSTEP_LANE void below(const Plan& plan, const Node& node, const Numbers& z) {
  for (int s = node.first_later; s < node.first_later + node.n_later; ++s) {
    const Later& later = plan.later[at(s)];
    double* block = z.A + kLanes * later.block;
    if (later.n_terms == 0)
      for (int k = 0; k < M * later.m; ++k) store(block, at(k), V{});
    for (int t = 0; t < later.n_terms; ++t) {
      const schur::Term& share = plan.terms[at(later.first_term + t)];
      const Side &p = side_of(plan, share.pivot_side), &q = side_of(plan, share.later_side);
      if (later.m == M && p.triple && q.triple)
        term<M, M>(M, M, p, q, z, block, t == 0);
      else
        term<M, 0>(M, later.m, p, q, z, block, t == 0);
    }
  }
}

/// D <- D^-1, lower triangle, symmetric positive definite, by sweeps.
template <int M>
LOCKSTEP_LANE void invert(V* D, const double* diagonal) {
  for (int k = 0; k < M; ++k) {
    const V d = 1.0 / larger(D[tri(k, k)], kPivotFloor * load(diagonal, at(k)));
    V u[M];
    for (int i = 0; i < M; ++i) u[i] = D[tri(i, k)] * d;
    for (int i = 0; i < M; ++i)
      for (int j = 0; j <= i; ++j)
        if (i != k && j != k) D[tri(i, j)] -= u[i] * D[tri(j, k)];
    for (int i = 0; i < M; ++i)
      if (i != k) D[tri(i, k)] = u[i];
    D[tri(k, k)] = -d;
  }
  for (int k = 0; k < M * (M + 1) / 2; ++k) D[k] = -D[k];
}

/// One pivot: D inverted, L = A D below it, the products taken from the later blocks; with kSolve also
/// x_later -= L x.
template <int M, bool kSolve>
LOCKSTEP_LANE void eliminate(const Plan& plan, const Node& node, const Numbers& z) {
  V D[M * (M + 1) / 2];
  double* d = z.A + kLanes * node.D;
  for (int k = 0; k < M * (M + 1) / 2; ++k) D[k] = load(d, at(k));
  invert<M>(D, z.diagonal + kLanes * node.x);
  for (int k = 0; k < M * (M + 1) / 2; ++k) store(d, at(k), D[k]);

  const Later* later = plan.later.data() + node.first_later;
  const std::size_t* target = plan.targets.data() + node.first_target;
  for (int s = 0; s < node.n_later; ++s) {
    double* As = z.A + kLanes * later[s].block;
    const int ms = later[s].m;
    for (int t = 0; t < s; ++t) {  // A_st -= A_s L_t^T; L_t stands already
      const double* Lt = z.A + kLanes * later[t].block;
      double* T = z.A + kLanes * *target++;
      const int mt = later[t].m;
      for (int i = 0; i < ms; ++i) {
        V a[M];
        for (int k = 0; k < M; ++k) a[k] = load(As, at(i * M + k));
        for (int j = 0; j < mt; ++j) {
          V sum = load(T, at(i * mt + j));
          for (int k = 0; k < M; ++k) sum -= a[k] * load(Lt, at(j * M + k));
          store(T, at(i * mt + j), sum);
        }
      }
    }
    double* T = z.A + kLanes * *target++;
    V L[6][M];
    for (int i = 0; i < ms; ++i) {
      V a[M];
      for (int k = 0; k < M; ++k) a[k] = load(As, at(i * M + k));
      for (int j = 0; j < M; ++j) {
        V l = a[0] * D[tri(0, j)];
        for (int k = 1; k < M; ++k) l += a[k] * D[tri(k, j)];
        L[i][j] = l;
      }
      for (int j = 0; j <= i; ++j) {  // A_ss -= L_s A_s^T
        V sum = load(T, at(tri(i, j)));
        for (int k = 0; k < M; ++k) sum -= L[i][k] * load(As, at(j * M + k));
        store(T, at(tri(i, j)), sum);
      }
      if constexpr (kSolve) {
        V b = load(z.x, later[s].x + at(i));
        for (int k = 0; k < M; ++k) b -= L[i][k] * load(z.x, node.x + at(k));
        store(z.x, later[s].x + at(i), b);
      }
    }
    for (int i = 0; i < ms; ++i)
      for (int k = 0; k < M; ++k) store(As, at(i * M + k), L[i][k]);
  }
}

/// x_later -= L x
template <int M>
LOCKSTEP_LANE void forward(const Plan& plan, const Node& node, const Numbers& z) {
  V x[M];
  for (int k = 0; k < M; ++k) x[k] = load(z.x, node.x + at(k));
  for (int s = node.first_later; s < node.first_later + node.n_later; ++s) {
    const Later& later = plan.later[at(s)];
    const double* L = z.A + kLanes * later.block;
    for (int i = 0; i < later.m; ++i) {
      V b = load(z.x, later.x + at(i));
      for (int k = 0; k < M; ++k) b -= load(L, at(i * M + k)) * x[k];
      store(z.x, later.x + at(i), b);
    }
  }
}
/// x <- D x - sum L^T x_later
template <int M>
LOCKSTEP_LANE void backward(const Plan& plan, const Node& node, const Numbers& z) {
  V x[M], y[M];
  const double* d = z.A + kLanes * node.D;
  for (int k = 0; k < M; ++k) x[k] = load(z.x, node.x + at(k));
  for (int i = 0; i < M; ++i) {
    y[i] = load(d, at(tri(i, 0))) * x[0];
    for (int k = 1; k < M; ++k) y[i] += load(d, at(tri(i, k))) * x[k];
  }
  for (int s = node.first_later; s < node.first_later + node.n_later; ++s) {
    const Later& later = plan.later[at(s)];
    const double* L = z.A + kLanes * later.block;
    for (int i = 0; i < later.m; ++i) {
      const V xi = load(z.x, later.x + at(i));
      for (int k = 0; k < M; ++k) y[k] -= load(L, at(i * M + k)) * xi;
    }
  }
  for (int k = 0; k < M; ++k) store(z.x, node.x + at(k), y[k]);
}

/// a -= Y^T x, lambda += x
template <int M, bool kTriple>
LOCKSTEP_LANE void apply_node(const Plan& plan, const Node& node, const Numbers& z) {
  V x[M];
  for (int k = 0; k < M; ++k) {
    x[k] = load(z.x, node.x + at(k));
    store(z.lambda, node.x + at(k), load(z.lambda, node.x + at(k)) + x[k]);
  }
  for (int i = node.first_side; i < node.first_side + node.n_sides; ++i) {
    const Side& side = side_of(plan, i);
    const double* Y = z.Y + kLanes * side.Y;
    double* a = z.a + kLanes * 6 * at(side.slot);
    if constexpr (kTriple) {
      const V im = side.sign * load(mass_of(z, side.slot), mass::inverse);
      for (int c = 0; c < 3; ++c) store(a, at(c), load(a, at(c)) - im * x[c]);
    }
    constexpr int kFirst = kTriple ? 3 : 0;
    for (int c = kFirst; c < 6; ++c) {
      V t = load(a, at(c));
      for (int k = 0; k < M; ++k) t -= load(Y, at((c - kFirst) * M + k)) * x[k];
      store(a, at(c), t);
    }
  }
}

/// sum of J u over the sides, u: 6 a slot; u_v and u_w begin at these packs of one slot, `stride` packs from slot to
/// slot.
template <int M, bool kTriple>
LOCKSTEP_LANE void times(const Plan& plan, const Node& node, const Numbers& z, const double* u, int stride, V* b) {
  for (int i = node.first_side; i < node.first_side + node.n_sides; ++i) {
    const Side& side = side_of(plan, i);
    const double *J = z.J + kLanes * side.J, *us = u + kLanes * stride * side.slot;
    constexpr int kFirst = kTriple ? 3 : 0;
    if constexpr (kTriple)
      for (int k = 0; k < 3; ++k) b[k] += side.sign * load(us, at(k));
    for (int c = kFirst; c < 6; ++c) {
      const V uc = load(us, at(c));
      for (int k = 0; k < M; ++k) b[k] += load(J, at((c - kFirst) * M + k)) * uc;
    }
  }
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
