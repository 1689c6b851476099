#include "framework/dynamics/solvers/schur_passes.h"

#include <lockstep/export.h>

namespace lockstep::schur {
namespace {

using K = PackedBlocks;

/// Turns c of one link from its own axes to those in which its rows are stored.
template <class X, int M, bool kTurned>
[[gnu::always_inline]] inline void turn_link(const Node& node, const double* given, const Numbers& z) {
  using Slab = K::Slab<M>;
  Slab c, ones{};
  std::memcpy(&c, given, sizeof c);
  for (int i = kTurned ? X::nv : 0; i < M; ++i) ones[i] = 1.0;
  c = c * ones;
  if constexpr (kTurned)
    for (int k = 0; k < X::nv; ++k) c += K::load<Slab>(z.rows + node.R + k * K::stride(M)) * given[k];
  K::store(z.c + node.x, c);
}

template <class X>
[[gnu::always_inline]] inline void turn_and_start(const Plan& plan, const double* c, const Numbers& z) {
  for_each_link<K, X>(
      plan, [&]<int M, bool kTurned>(const Node& node) __attribute__((always_inline)) {
        turn_link<X, M, kTurned>(node, c + node.first_row, z);
        start_link<K, X, M, kTurned>(plan, node, z);
      });
}

// No header declares these: of a function that was declared without the attribute clang 14 takes the first variant for
// every machine.
LOCKSTEP_CLONES void fill_spatial(const Plan& plan, const Numbers& z) { fill_links<K, Spatial>(plan, z); }
LOCKSTEP_CLONES void fill_planar(const Plan& plan, const Numbers& z) { fill_links<K, Planar>(plan, z); }
LOCKSTEP_CLONES void fill_blocks_spatial(const Plan& plan, const Numbers& z) { fill_blocks<K, Spatial>(plan, z); }
LOCKSTEP_CLONES void fill_blocks_planar(const Plan& plan, const Numbers& z) { fill_blocks<K, Planar>(plan, z); }
LOCKSTEP_CLONES void start_spatial(const Plan& plan, const double* c, const Numbers& z) {
  turn_and_start<Spatial>(plan, c, z);
}
LOCKSTEP_CLONES void start_planar(const Plan& plan, const double* c, const Numbers& z) {
  turn_and_start<Planar>(plan, c, z);
}
LOCKSTEP_CLONES void apply_spatial(const Plan& plan, const double* x, const Numbers& z) {
  apply_links<K, Spatial>(plan, x, z);
}
LOCKSTEP_CLONES void apply_planar(const Plan& plan, const double* x, const Numbers& z) {
  apply_links<K, Planar>(plan, x, z);
}
LOCKSTEP_CLONES void residual_spatial(const Plan& plan, const Numbers& z) { residuals<K, Spatial>(plan, z); }
LOCKSTEP_CLONES void residual_planar(const Plan& plan, const Numbers& z) { residuals<K, Planar>(plan, z); }
LOCKSTEP_CLONES void factor_all(const Plan& plan, const Numbers& z) { factor_nodes<K, false>(plan, z); }
LOCKSTEP_CLONES void solve_all(const Plan& plan, const Numbers& z) {
  solve_forward<K>(plan, z);
  solve_backward<K>(plan, z);
}
LOCKSTEP_CLONES bool all_rows_met(const Plan& plan, double tolerance, const Numbers& z) {
  bool unmet = false;
  check_rows<K>(plan, tolerance, z, unmet);
  return !unmet;
}

}  // namespace

void fill(const Plan& plan, const Numbers& z) {
  plan.planar ? fill_planar(plan, z) : fill_spatial(plan, z);
  for (const int h : plan.hubs)
    plan.planar ? fill_hub<K, Planar>(plan.nodes[h], z) : fill_hub<K, Spatial>(plan.nodes[h], z);
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
