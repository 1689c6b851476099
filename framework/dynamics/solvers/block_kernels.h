// SPDX-License-Identifier: BSD-3-Clause
// Kernels of the block factorisation: triangles and products of small dense blocks. T is double or complex.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>

#include "framework/foundation/math/for_size.h"

namespace lockstep {
namespace block_detail {

/// a b. The standard library's complex product checks for infinities first.
inline double times(double a, double b) { return a * b; }
inline std::complex<double> times(const std::complex<double>& a, const std::complex<double>& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}
inline std::complex<double> times(double a, const std::complex<double>& b) { return {a * b.real(), a * b.imag()}; }
inline double size_of(double a) { return std::abs(a); }
inline double size_of(const std::complex<double>& a) { return std::abs(a.real()) + std::abs(a.imag()); }

/// C -= X^T Y; X: n_k x n_i, Y: n_k x kJ, C: n_i x kJ, row-major.
template <int kJ, class T>
inline void subtract_product(T* C, const T* X, const T* Y, int n_k, int n_i) {
  for (int i = 0; i < n_i; ++i) {
    T row[kJ];
    for (int j = 0; j < kJ; ++j) row[j] = C[i * kJ + j];
    for (int k = 0; k < n_k; ++k) {
      const T x = X[k * n_i + i];
      for (int j = 0; j < kJ; ++j) row[j] -= times(x, Y[k * kJ + j]);
    }
    for (int j = 0; j < kJ; ++j) C[i * kJ + j] = row[j];
  }
}

// Triangles share one block D of n x n, row-major; a diagonal that is not all ones is stored as reciprocals.

/// X <- L^-1 X, X: n x kJ; kUnit: the diagonal of L is 1; kTransposed: the upper triangle of D is L^T.
template <int kJ, bool kUnit, bool kTransposed = false, class T>
inline void solve_lower(const T* D, T* X, int n) {
  for (int i = 0; i < n; ++i) {
    T row[kJ];
    for (int j = 0; j < kJ; ++j) row[j] = X[i * kJ + j];
    for (int k = 0; k < i; ++k) {
      const T d = D[kTransposed ? k * n + i : i * n + k];
      for (int j = 0; j < kJ; ++j) row[j] -= times(d, X[k * kJ + j]);
    }
    for (int j = 0; j < kJ; ++j) X[i * kJ + j] = kUnit ? row[j] : times(D[i * n + i], row[j]);
  }
}

/// L L^T = sign D in the lower triangle; pivots: the squares of L's diagonal. False if one is not positive.
inline bool cholesky(double* D, int n, double sign, double* pivots) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) {
      double s = sign * D[i * n + j];
      for (int k = 0; k < j; ++k) s -= D[i * n + k] * D[j * n + k];
      if (j < i) {
        D[i * n + j] = s * D[j * n + j];
        continue;
      }
      pivots[i] = s;
      if (!(s > 0)) return false;
      D[i * n + i] = 1.0 / std::sqrt(s);
    }
  return true;
}

/// L R = D with rows exchanged, row k with row order[k] >= k; returns the smallest pivot relative to the largest number
/// of D, 0 on failure.
template <class T>
inline double lu(T* D, int n, unsigned char* order) {
  double smallest = HUGE_VAL, size = 0;
  for (int i = 0; i < n * n; ++i) size = std::max(size, size_of(D[i]));
  for (int k = 0; k < n; ++k) {
    int p = k;
    for (int i = k + 1; i < n; ++i)
      if (size_of(D[i * n + k]) > size_of(D[p * n + k])) p = i;
    const double pivot = size_of(D[p * n + k]);
    if (!(pivot > 0) || !std::isfinite(pivot)) return 0;
    smallest = std::min(smallest, pivot);
    order[k] = static_cast<unsigned char>(p);
    if (p != k) std::swap_ranges(D + k * n, D + k * n + n, D + p * n);
    const T inverse = T(1) / D[k * n + k];
    D[k * n + k] = inverse;
    for (int i = k + 1; i < n; ++i) {
      const T f = D[i * n + k] = times(D[i * n + k], inverse);
      for (int j = k + 1; j < n; ++j) D[i * n + j] -= times(f, D[k * n + j]);
    }
  }
  return smallest / size;
}
template <class T>
inline void exchange_rows(T* X, int n, int n_columns, const unsigned char* order) {
  for (int k = 0; k < n; ++k)
    if (order[k] != k) std::swap_ranges(X + k * n_columns, X + (k + 1) * n_columns, X + order[k] * n_columns);
}

}  // namespace block_detail

}  // namespace lockstep
