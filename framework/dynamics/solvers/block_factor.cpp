// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/solvers/block_factor.h"

#include <lockstep/detail/export.h>
#include "framework/dynamics/solvers/block_kernels.h"
#include "framework/foundation/support/clones.h"

namespace lockstep {
namespace block_detail {

using Complex = std::complex<double>;
using Node = BlockPlan::Node;
using Later = BlockPlan::Later;

/// The passes over the blocks A of a plan. E: T to factor, const T to solve.
template <class E>
struct Passes {
  using T = std::remove_const_t<E>;
  const BlockPlan& plan;
  E* A;

  const Later* later(const Node& pivot) const { return plan.later.data() + pivot.first_later; }
  const std::size_t* targets(const Node& pivot) const { return plan.targets.data() + pivot.first_target; }

  void eliminate_symmetric(const Node& pivot) const {
    const Later* s = later(pivot);
    const std::size_t* target = targets(pivot);
    const int n = pivot.width;
    T X[kMaxBlock * kMaxBlock];  // sign W_b
    for (int b = 0; b < pivot.n_later; ++b)
      for_size(
          s[b].width, [&]<int kJ>(std::integral_constant<int, kJ>) __attribute__((always_inline)) {
            T* W = A + s[b].U;
            solve_lower<kJ, false>(A + pivot.D, W, n);
            for (int i = 0; i < n * kJ; ++i) X[i] = pivot.sign * W[i];
            for (int a = 0; a <= b; ++a) subtract_product<kJ>(A + *target++, A + s[a].U, X, n, s[a].width);
          });
  }

  // Subtracts Z_a^T W_b from block (a, b), and W_a^T Z_b from its mirror image, which is stored transposed.
  void eliminate(const Node& pivot, const unsigned char* order) const {
    const Later* s = later(pivot);
    const std::size_t* target = targets(pivot);
    const int n = pivot.width;
    for (int b = 0; b < pivot.n_later; ++b)
      for_size(
          s[b].width, [&]<int kJ>(std::integral_constant<int, kJ>) __attribute__((always_inline)) {
            T *W_b = A + s[b].U, *Z_b = W_b + n * kJ;
            exchange_rows(W_b, n, kJ, order);
            solve_lower<kJ, true>(A + pivot.D, W_b, n);
            solve_lower<kJ, false, true>(A + pivot.D, Z_b, n);  // R^T
            for (int a = 0; a <= b; ++a, ++target) {
              const int n_a = s[a].width;
              const T* W_a = A + s[a].U;
              subtract_product<kJ>(A + *target, W_a + n * n_a, W_b, n, n_a);
              if (a < b) subtract_product<kJ>(A + *target + n_a * kJ, W_a, Z_b, n, n_a);
            }
          });
  }

  void forward(const Node& pivot, const unsigned char* order, T* b) const {
    const int n = pivot.width;
    T* y = b + pivot.first;
    if (plan.symmetric) {
      solve_lower<1, false>(A + pivot.D, y, n);
      for (int i = 0; i < n; ++i) y[i] *= pivot.sign;
    } else {
      exchange_rows(y, n, 1, order);
      solve_lower<1, true>(A + pivot.D, y, n);
    }
    const Later* s = later(pivot);
    for (int l = 0; l < pivot.n_later; ++l) {
      const T* Z = A + s[l].U + (plan.symmetric ? 0 : n * s[l].width);
      for_size(
          s[l].width, [&](auto width) __attribute__((always_inline)) {
            subtract_product<decltype(width)::value>(b + s[l].first, y, Z, n, 1);
          });
    }
  }

  void backward(const Node& pivot, T* b) const {
    const int n = pivot.width;
    T* x = b + pivot.first;
    const Later* s = later(pivot);
    for (int l = 0; l < pivot.n_later; ++l) {
      const T* W = A + s[l].U;
      const T* x_s = b + s[l].first;
      for_size(
          s[l].width, [&]<int kJ>(std::integral_constant<int, kJ>) __attribute__((always_inline)) {
            for (int i = 0; i < n; ++i) {
              T sum(0);
              for (int j = 0; j < kJ; ++j) sum += times(W[i * kJ + j], x_s[j]);
              x[i] -= plan.symmetric ? pivot.sign * sum : sum;
            }
          });
    }
    const T* D = A + pivot.D;  // R: above the diagonal, or L^T below it
    for (int i = n - 1; i >= 0; --i) {
      for (int j = i + 1; j < n; ++j) x[i] -= times(plan.symmetric ? D[j * n + i] : D[i * n + j], x[j]);
      x[i] = times(D[i * n + i], x[i]);
    }
  }

  bool factor(unsigned char* order) const {
    for (const Node& pivot : plan.nodes) {
      if (!(lu(A + pivot.D, pivot.width, order) > 0)) return false;
      eliminate(pivot, order);
      order += kMaxBlock;
    }
    return true;
  }

  void solve(const unsigned char* order, T* b) const {
    const int n = static_cast<int>(plan.nodes.size());
    const Node* nodes = plan.nodes.data();
    for (int k = 0; k < n; ++k) forward(nodes[k], order + (plan.symmetric ? 0 : k * kMaxBlock), b);
    for (int k = n - 1; k >= 0; --k) backward(nodes[k], b);
  }
};

// Compiled for each instruction set (LOCKSTEP_FLAT_CLONES).
LOCKSTEP_FLAT_CLONES bool factor_symmetric(const BlockPlan& plan, double* A, double* pivots) {
  const Passes<double> passes{plan, A};
  for (const Node& pivot : plan.nodes) {
    if (!cholesky(A + pivot.D, pivot.width, pivot.sign, pivots + pivot.first)) return false;
    passes.eliminate_symmetric(pivot);
  }
  return true;
}
LOCKSTEP_FLAT_CLONES bool factor(const BlockPlan& plan, double* A, unsigned char* order) {
  return Passes<double>{plan, A}.factor(order);
}
LOCKSTEP_FLAT_CLONES bool factor(const BlockPlan& plan, Complex* A, unsigned char* order) {
  return Passes<Complex>{plan, A}.factor(order);
}
LOCKSTEP_FLAT_CLONES void solve(const BlockPlan& plan, const double* A, const unsigned char* order, double* b) {
  Passes<const double>{plan, A}.solve(order, b);
}
LOCKSTEP_FLAT_CLONES void solve(const BlockPlan& plan, const Complex* A, const unsigned char* order, Complex* b) {
  Passes<const Complex>{plan, A}.solve(order, b);
}

}  // namespace block_detail

template <class T>
bool BlockFactor<T>::factor_symmetric(const BlockPlan& plan, double* pivots) {
  if constexpr (std::is_same_v<T, double>)
    return block_detail::factor_symmetric(plan, A_.data(), pivots);
  else
    return false;
}
template <class T>
bool BlockFactor<T>::factor(const BlockPlan& plan) {
  return block_detail::factor(plan, A_.data(), order_.data());
}
template <class T>
void BlockFactor<T>::solve(const BlockPlan& plan, T* b) const {
  block_detail::solve(plan, A_.data(), order_.data(), b);
}

template class BlockFactor<double>;
template class BlockFactor<std::complex<double>>;

}  // namespace lockstep
