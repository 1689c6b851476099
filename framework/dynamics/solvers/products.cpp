// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/solvers/products.h"

#include <cmath>

namespace lockstep {

namespace {

template <class Term>
void mass_times(const KktPattern& pattern, const std::vector<double>& B, const VecX& x, VecX& y, Term term) {
  for_each_mass(pattern, [&](int first, int width, std::size_t at) {
    const double* b = B.data() + at;
    for (int i = 0; i < width; ++i)
      for (int k = 0; k < width; ++k) y[first + i] += term(*b++ * x[first + k]);
  });
}

template <class Term>
void rows_transposed_times(const Kkt& kkt, const VecX& lambda, VecX& y, Term term) {
  for_each_jacobian(kkt.pattern, [&](const KktLink& link, int first, int width, std::size_t at) {
    const double* b = kkt.J.data() + at;
    for (int j = 0; j < link.m; ++j)
      for (int k = 0; k < width; ++k) y[first + k] += term(*b++ * lambda[link.first_row + j]);
  });
}

}  // namespace

void add_mass_times(const KktPattern& pattern, const std::vector<double>& B, const VecX& x, VecX& y) {
  mass_times(pattern, B, x, y, [](double v) { return v; });
}
void add_rows_times(const Kkt& kkt, const VecX& x, VecX& y) {
  for_each_jacobian(kkt.pattern, [&](const KktLink& link, int first, int width, std::size_t at) {
    const double* b = kkt.J.data() + at;
    for (int j = 0; j < link.m; ++j)
      for (int k = 0; k < width; ++k) y[link.first_row + j] += *b++ * x[first + k];
  });
}
void subtract_rows_transposed_times(const Kkt& kkt, const VecX& lambda, VecX& y) {
  rows_transposed_times(kkt, lambda, y, [](double v) { return -v; });
}
void add_sizes_of_mass_times(const KktPattern& pattern, const std::vector<double>& B, const VecX& x, VecX& y) {
  mass_times(pattern, B, x, y, [](double v) { return std::abs(v); });
}
void add_sizes_of_rows_transposed_times(const Kkt& kkt, const VecX& lambda, VecX& y) {
  rows_transposed_times(kkt, lambda, y, [](double v) { return std::abs(v); });
}

void row_diagonal(const Kkt& kkt, VecX& s) {
  s.setZero();
  add_row_diagonal(kkt, s, [] { return true; });
}

}  // namespace lockstep
