// What goes into the elimination (elimination.h), node by node: S + E from the rows and masses, and right sides.
#pragma once

#include "framework/dynamics/solvers/elimination.h"

namespace lockstep::schur {

#define LOCKSTEP_KERNEL [[gnu::always_inline]] inline

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
/// The largest a . M a over the slots.
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
  typename K::Number t{}, r{}, f{};  // not an array: they stay in registers
  for (const Node& node : plan.nodes)
    for (int k = 0; node.link >= 0 && k < node.m; ++k) {
      const typename K::Number value = K::number(values, node.x + k);
      switch (node.kinds.of(k)) {
        case RowKind::translation:
          t = larger(value, t);
          break;
        case RowKind::rotation:
          r = larger(value, r);
          break;
        case RowKind::function:
          f = larger(value, f);
          break;
      }
    }
  largest[0] = t, largest[1] = r, largest[2] = f;
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
        for (int k = 0; k < X::nw; ++k) diagonal[i] += J(kAngular + c) * K::number(I, X::I[c][k]) * J(kAngular + k);
    }
  }
}

/// E = eps s_j, added to the diagonal of S.
template <class K, int M>
LOCKSTEP_KERNEL void add_proximal(const Node& node, const Numbers& z, typename K::Number* diagonal,
                                  typename K::template Square<M>& D) {
  typename K::Number s[M];
  for (int i = 0; i < M; ++i) s[i] = diagonal[i];
  average_scales(s, M, node.kinds);
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
    const bool own = !K::kPacked || !side.hub;  // a hub has its own columns instead; lanes have no hubs
    const double *J = K::at(z.rows, side.J), *I = K::at(z.inverse, X::mass * side.slot);
    double* Y = K::at(z.Y, side.Y);
    const auto take = [&](int c, auto i, const Slab& y) __attribute__((always_inline)) {
      K::store(K::at(Y, c * K::stride(M) + i), y);
      if (own)
        unrolled<K::columns(i, M)>([&](auto j) __attribute__((always_inline)) {
          D.slab(i, j) += y * K::number(J, c * K::stride(M) + j);
        });
    };
    const auto Jc = [&](int c, int i) __attribute__((always_inline)) {
      return K::template load<Slab>(K::at(J, c * K::stride(M) + i));
    };
    unrolled<K::slabs(M)>([&](auto i) __attribute__((always_inline)) {
      for (int c = 0; c < kAngular; ++c) take(c, i, Jc(c, i) * K::number(I, 0));
      for (int c = 0; c < X::nw; ++c) {
        Slab y = Jc(kAngular, i) * K::number(I, X::I[c][0]);
        for (int k = 1; k < X::nw; ++k) y += Jc(kAngular + k, i) * K::number(I, X::I[c][k]);
        take(kAngular + c, i, y);
      }
    });
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

/// Share of a slot in the block between two links of one size, both turned: J_later M^-1 J_pivot^T. `first`: the block
/// is written, not added to.
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

// ------------------------------------------------------------------------------------------------- right sides

/// t = J u of one link and slot, in the axes that its rows are kept in; u: numbers of one slot, v then w.
template <class K, class X, int M, bool kTurned>
LOCKSTEP_KERNEL void rows_times(const Side& side, const Numbers& z, const double* u, typename K::template Slab<M>* t) {
  using Slab = typename K::template Slab<M>;
  constexpr int kFirst = kTurned ? X::nv : 0;
  for (int i = 0; i < K::slabs(M); ++i) {
    const auto term = [&](int c) __attribute__((always_inline))->Slab {
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

/// x = J a - c of one link and the scales |J a| + |c|; a on hubs is still unknown, and only enters the scale.
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

/// Marks the rows where |r| is not within `tolerance` of the scale, which is at least the floor; a NaN never is.
template <class K>
LOCKSTEP_KERNEL void check_link(const Node& node, const Numbers& z, double tolerance, typename K::Marks& unmet) {
  K::with_slab(
      node.m, [&]<class Slab>() __attribute__((always_inline)) {
        for (int i = 0; i < K::slabs(node.m); ++i) {
          const Slab scale = K::template load<Slab>(K::at(z.scale, node.x + i)),
                     floor = K::template floor<Slab>(z, node, i);
          const Slab limit = tolerance * larger(scale, floor);
          K::mark(unmet, size_of(K::template load<Slab>(K::at(z.r, node.x + i))), limit);
        }
      });
}

#undef LOCKSTEP_KERNEL

}  // namespace lockstep::schur
