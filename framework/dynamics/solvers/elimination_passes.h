// The passes of the elimination over all nodes of a plan (elimination.h, elimination_rows.h), for any storage K and
// geometry X.
#pragma once

#include "framework/dynamics/solvers/elimination_rows.h"

namespace lockstep::schur {

#define LOCKSTEP_KERNEL [[gnu::always_inline]] inline

/// Calls f<M, kTurned>(node) for a link, with its rows as constants.
template <class K, class X, class F>
LOCKSTEP_KERNEL void with_rows(const Node& node, F&& f) {
  if (node.turned)
    for_size<X::nv, K::kMostTurned>(
        node.m, [&](auto m) __attribute__((always_inline)) { f.template operator()<m, true>(node); });
  else
    for_size<1, K::kMostDense>(
        node.m, [&](auto m) __attribute__((always_inline)) { f.template operator()<m, false>(node); });
}
template <class K, class X, class F>
LOCKSTEP_KERNEL void for_each_link(const Plan& plan, F&& f) {
  for (const Node& node : plan.nodes)
    if (node.link >= 0) with_rows<K, X>(node, f);
}

// -- hubs

/// The mass of a hub, negative.
template <class K, class X>
void fill_hub(const Node& node, const Numbers& z) {
  const double* M = K::at(z.mass, X::mass * node.hub_slot);
  double* d = K::at(z.A, node.D);
  for (int i = 0; i < node.m; ++i)
    for (int k = 0; k < K::stride(node.m); ++k) K::put(d, K::square(k, i, node.m), 0.0);
  for (int i = 0; i < X::nv; ++i) K::put(d, K::square(i, i, node.m), -K::number(M, 0));
  for (int i = 0; i < X::nw; ++i)
    for (int k = 0; k < X::nw; ++k) K::put(d, K::square(X::nv + k, X::nv + i, node.m), -K::number(M, X::I[i][k]));
  for (int i = 0; i < node.m; ++i) {
    K::put(z.diagonal, node.x + i, -K::number(d, K::square(i, i, node.m)));
    K::put(z.E, node.x + i, 0.0);
  }
}

/// -J of a link on a hub: the block between the two, whichever goes first.
template <class K, class X>
void fill_hub_term(const Plan& plan, const Node& pivot, const Later& later, const Term& term, const Numbers& z) {
  const Side& side = plan.sides[term.pivot_side < 0 ? term.later_side : term.pivot_side];
  const int m = term.pivot_side < 0 ? later.m : pivot.m;
  const auto J = [&](int row, int c) {
    if (side.turned && c < X::nv) return row == c ? side.sign : 0.0;
    return K::number(K::at(z.rows, side.J), (side.turned ? c - X::nv : c) * K::stride(m) + row);
  };
  double* block = K::at(z.A, later.block);
  for (int i = 0; i < pivot.m; ++i)
    for (int j = 0; j < later.m; ++j) {
      const int at = K::below(j, i, later.m, pivot.m);
      K::put(block, at, K::number(block, at) - (term.pivot_side < 0 ? J(j, i) : J(i, j)));
    }
}

// -- rows -> S + E

template <class K, class X>
LOCKSTEP_KERNEL void fill_links(const Plan& plan, const Numbers& z) {
  for_each_link<K, X>(
      plan, [&]<int M, bool kTurned>(const Node& node)
                __attribute__((always_inline)) { fill_own<K, X, M, kTurned>(plan, node, z); });
}

/// The block between a pivot and one later node: a sum over the slots that both touch.
template <class K, class X, int M>
LOCKSTEP_KERNEL void fill_below(const Plan& plan, const Node& node, const Later& later, const Numbers& z) {
  double* block = K::at(z.A, later.block);
  const auto clear = [&] {
    for (int k = 0; k < K::stride(later.m) * M; ++k) K::put(block, k, typename K::Number{});
  };
  bool first = true;  // the block is to be written
  if (later.n_terms == 0) clear();
  for (const Term& term : plan.terms_of(later)) {
    const bool on_hub = K::kPacked && (term.pivot_side < 0 || term.later_side < 0);
    const Side *p = plan.sides.data() + term.pivot_side, *q = plan.sides.data() + term.later_side;
    if (M >= X::nv && later.m == M && !on_hub && p->turned && q->turned) {
      fill_term<K, X, M>(*p, *q, z, block, first);
    } else {
      if (K::kPacked && first) clear(), first = false;  // with the padding of the columns
      if constexpr (K::kPacked)
        if (on_hub) fill_hub_term<K, X>(plan, node, later, term, z);
      if (!on_hub) fill_any_term<K, X>(M, *p, later.m, *q, z, block, first);
    }
    first = false;
  }
}

template <class K, class X>
LOCKSTEP_KERNEL void fill_blocks(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    if (node.n_later > 0)
      for_size<1, K::kMostTurned>(
          node.m, [&](auto m) __attribute__((always_inline)) {
            for (const Later& later : plan.later_of(node)) fill_below<K, X, m>(plan, node, later, z);
          });
}

// -- S + E -> factor, and its solutions

/// D and L; with kSolve also the first half of the solution x <- (S + E)^-1 x.
template <class K, bool kSolve>
LOCKSTEP_KERNEL void factor_nodes(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    for_size<1, K::kMostTurned>(
        node.m, [&](auto m) __attribute__((always_inline)) { eliminate<K, m, kSolve>(plan, node, z); });
}
template <class K>
LOCKSTEP_KERNEL void solve_forward(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    for_size<1, K::kMostTurned>(
        node.m, [&](auto m) __attribute__((always_inline)) { forward<K, m>(plan, node, z); });
}
template <class K>
LOCKSTEP_KERNEL void solve_backward(const Plan& plan, const Numbers& z) {
  for (std::size_t k = plan.nodes.size(); k-- > 0;) {
    const Node& node = plan.nodes[k];
    for_size<1, K::kMostTurned>(
        node.m, [&](auto m) __attribute__((always_inline)) { backward<K, m>(plan, node, z); });
  }
}

// -- right sides

template <class K, class X>
LOCKSTEP_KERNEL void apply_links(const Plan& plan, const double* x, const Numbers& z) {
  for_each_link<K, X>(
      plan, [&]<int M, bool kTurned>(const Node& node)
                __attribute__((always_inline)) { apply_link<K, X, M, kTurned>(plan, node, K::at(x, node.x), z); });
}
template <class K, class X>
LOCKSTEP_KERNEL void residuals(const Plan& plan, const Numbers& z) {
  for_each_link<K, X>(
      plan, [&]<int M, bool kTurned>(const Node& node)
                __attribute__((always_inline)) { residual_link<K, X, M, kTurned>(plan, node, z); });
}
template <class K>
LOCKSTEP_KERNEL void check_rows(const Plan& plan, double tolerance, const Numbers& z, typename K::Marks& unmet) {
  for (const Node& node : plan.nodes)
    if (node.link >= 0) check_link<K>(node, z, tolerance, unmet);
}

#undef LOCKSTEP_KERNEL

}  // namespace lockstep::schur
