// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/solvers/schur_passes.h"

#include <lockstep/detail/export.h>
#include "framework/dynamics/solvers/elimination_rows.h"

namespace lockstep::schur {
namespace {

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
