// BlockFactor: the numeric half of the block factorisation: no allocation, no search. T is double or complex.
//
//   pivot k:   A_kk = L R                        later neighbours s, t:   W_s = L^-1 A_ks,   Z_s^T = A_sk R^-1
//              A_st -= Z_s^T W_t
//   solve:     y_k = L^-1 b_k, b_s -= Z_s^T y_k  forward;   x_k = R^-1 (y_k - sum_s W_s x_s)  backward
//
// Unsymmetric: L R with pivots by rows inside the block. Symmetric: sign A_kk = L L^T, sign = +1 for a slot, -1 for a
// link (quasi-definite, Vanderbei 1995); Z_s = W_s up to the sign, and only W is kept. Triangles, never inverses: rows
// that depend on one another leave a block that is all but singular, and its inverse would lose what they share.
#pragma once

#include <algorithm>
#include <vector>

#include "framework/kkt/block_kernels.h"

namespace lockstep {

template <class T>
class BlockFactor {
 public:
  using Node = BlockPlan::Node;
  using Later = BlockPlan::Later;

  void lay_out(const BlockPlan& plan) {
    A_.assign(plan.size, T(0));
    order_.assign(plan.symmetric ? 0 : plan.nodes.size() * kMaxBlock, 0);
  }
  void clear() { std::fill(A_.begin(), A_.end(), T(0)); }
  /// Numbers of a block, at a place found in the plan.
  T* at(std::size_t place) { return A_.data() + place; }

  /// Symmetric plan. pivots: one an unknown, as in block_detail::cholesky. False where a pivot has the wrong sign.
  bool factor_symmetric(const BlockPlan& plan, double* pivots) {
    for (const Node& pivot : plan.nodes) {
      if (!block_detail::cholesky(at(pivot.D), pivot.width, pivot.sign, pivots + pivot.first)) return false;
      eliminate_symmetric(plan, pivot);
    }
    return true;
  }
  /// Unsymmetric plan. refused(pivot, ratio) is asked after each block with the smallest pivot inside it against its
  /// largest number, 0 where there is none: true ends the factorisation.
  template <class Refused>
  bool factor(const BlockPlan& plan, Refused&& refused) {
    for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
      const Node& pivot = plan.nodes[k];
      unsigned char* order = order_.data() + k * kMaxBlock;
      if (refused(pivot, block_detail::lu(at(pivot.D), pivot.width, order))) return false;
      eliminate(plan, pivot, order);
    }
    return true;
  }

  /// b becomes the solution.
  void solve(const BlockPlan& plan, T* b) const {
    for (std::size_t k = 0; k < plan.nodes.size(); ++k) forward(plan, k, b);
    for (std::size_t k = plan.nodes.size(); k-- > 0;) backward(plan, k, b);
  }

 private:
  const T* at(std::size_t place) const { return A_.data() + place; }
  static const Later* later(const BlockPlan& plan, const Node& pivot) { return plan.later.data() + pivot.first_later; }

  void eliminate_symmetric(const BlockPlan& plan, const Node& pivot) {
    const Later* s = later(plan, pivot);
    const std::size_t* target = plan.targets.data() + pivot.first_target;
    const int n = pivot.width;
    T X[kMaxBlock * kMaxBlock];  // sign W_b
    for (int b = 0; b < pivot.n_later; ++b)
      block_detail::with_width(s[b].width, [&](auto width) {
        constexpr int kJ = decltype(width)::value;
        T* W = at(s[b].U);
        block_detail::solve_lower<kJ, false>(at(pivot.D), W, n);
        for (int i = 0; i < n * kJ; ++i) X[i] = pivot.sign * W[i];
        for (int a = 0; a <= b; ++a) block_detail::subtract_product<kJ>(at(*target++), at(s[a].U), X, n, s[a].width);
      });
  }

  // Block (a, b) takes Z_a^T W_b; its mirror image, kept transposed, W_a^T Z_b.
  void eliminate(const BlockPlan& plan, const Node& pivot, const unsigned char* order) {
    const Later* s = later(plan, pivot);
    const std::size_t* target = plan.targets.data() + pivot.first_target;
    const int n = pivot.width;
    for (int b = 0; b < pivot.n_later; ++b)
      block_detail::with_width(s[b].width, [&](auto width) {
        constexpr int kJ = decltype(width)::value;
        T *W_b = at(s[b].U), *Z_b = W_b + n * kJ;
        block_detail::exchange_rows(W_b, n, kJ, order);
        block_detail::solve_lower<kJ, true>(at(pivot.D), W_b, n);
        block_detail::solve_upper_transposed<kJ>(at(pivot.D), Z_b, n);
        for (int a = 0; a <= b; ++a, ++target) {
          const int n_a = s[a].width;
          const T* W_a = at(s[a].U);
          block_detail::subtract_product<kJ>(at(*target), W_a + n * n_a, W_b, n, n_a);
          if (a < b) block_detail::subtract_product<kJ>(at(*target) + n_a * kJ, W_a, Z_b, n, n_a);
        }
      });
  }

  void forward(const BlockPlan& plan, std::size_t k, T* b) const {
    const Node& pivot = plan.nodes[k];
    const int n = pivot.width;
    T* y = b + pivot.first;
    if (plan.symmetric) {
      block_detail::solve_lower<1, false>(at(pivot.D), y, n);
      for (int i = 0; i < n; ++i) y[i] *= pivot.sign;
    } else {
      block_detail::exchange_rows(y, n, 1, order_.data() + k * kMaxBlock);
      block_detail::solve_lower<1, true>(at(pivot.D), y, n);
    }
    const Later* s = later(plan, pivot);
    for (int l = 0; l < pivot.n_later; ++l) {
      const int n_s = s[l].width;
      const T* Z = at(s[l].U) + (plan.symmetric ? 0 : n * n_s);
      block_detail::with_width(
          n_s, [&](auto width) { block_detail::subtract_product<decltype(width)::value>(b + s[l].first, y, Z, n, 1); });
    }
  }

  void backward(const BlockPlan& plan, std::size_t k, T* b) const {
    const Node& pivot = plan.nodes[k];
    const int n = pivot.width;
    T* x = b + pivot.first;
    const Later* s = later(plan, pivot);
    for (int l = 0; l < pivot.n_later; ++l) {
      const T* W = at(s[l].U);
      const T* x_s = b + s[l].first;
      block_detail::with_width(s[l].width, [&](auto width) {
        constexpr int kJ = decltype(width)::value;
        for (int i = 0; i < n; ++i) {
          T sum(0);
          for (int j = 0; j < kJ; ++j) sum += block_detail::times(W[i * kJ + j], x_s[j]);
          x[i] -= plan.symmetric ? pivot.sign * sum : sum;
        }
      });
    }
    const T* D = at(pivot.D);  // R: above the diagonal, or L^T below it
    for (int i = n - 1; i >= 0; --i) {
      for (int j = i + 1; j < n; ++j) x[i] -= block_detail::times(plan.symmetric ? D[j * n + i] : D[i * n + j], x[j]);
      x[i] = block_detail::times(D[i * n + i], x[i]);
    }
  }

  std::vector<T> A_;
  std::vector<unsigned char> order_;  // kMaxBlock a pivot
};

}  // namespace lockstep
