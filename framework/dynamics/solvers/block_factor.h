// SPDX-License-Identifier: BSD-3-Clause
// BlockFactor: the numeric half of the block factorisation: no allocation, no search. T is double or complex.
//
//   pivot k:   A_kk = L R                        later neighbours s, t:   W_s = L^-1 A_ks,   Z_s^T = A_sk R^-1
//              A_st -= Z_s^T W_t
//   solve:     y_k = L^-1 b_k, b_s -= Z_s^T y_k  forward;   x_k = R^-1 (y_k - sum_s W_s x_s)  backward
//
// Unsymmetric: L R with pivots by rows inside the block. Symmetric: sign A_kk = L L^T, sign = +1 for a slot, -1 for a
// link (quasi-definite, Vanderbei 1995); Z_s = W_s up to the sign, and only W is kept. Triangles, not inverses:
// dependent rows leave a nearly singular block, and its inverse would lose the part that they share.
#pragma once

#include <algorithm>
#include <complex>
#include <vector>

#include "framework/dynamics/solvers/block_plan.h"

namespace lockstep {

template <class T>
class LOCKSTEP_API BlockFactor {
 public:
  void lay_out(const BlockPlan& plan) {
    A_.assign(plan.size, T(0));
    order_.assign(plan.symmetric ? 0 : plan.nodes.size() * kMaxBlock, 0);
  }
  void clear() { std::fill(A_.begin(), A_.end(), T(0)); }
  /// The numbers of the block at a place that the plan found.
  T* at(std::size_t place) { return A_.data() + place; }

  /// For a symmetric plan; T = double only. pivots: the squares of L's diagonal, one per unknown. False if a pivot has
  /// the wrong sign.
  bool factor_symmetric(const BlockPlan& plan, double* pivots);
  /// For an unsymmetric plan. False if a block has no pivot.
  bool factor(const BlockPlan& plan);
  /// b becomes the solution.
  void solve(const BlockPlan& plan, T* b) const;

 private:
  std::vector<T> A_;
  std::vector<unsigned char> order_;  // row exchanges, kMaxBlock per pivot
};

extern template class BlockFactor<double>;
extern template class BlockFactor<std::complex<double>>;

}  // namespace lockstep
