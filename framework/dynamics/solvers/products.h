// SPDX-License-Identifier: BSD-3-Clause
// Products with the blocks of the saddle-point matrix. Plain loops: the blocks are small, and nothing is allocated.
#pragma once

#include <lockstep/author/solver.h>

namespace lockstep {

/// The kind of row k of a link; a unit-length row counts as a function.
inline RowKind kind_of(const KktLink& link, int k) { return link.link < 0 ? RowKind::function : link.kind[k]; }

/// visit(link, first unknown of the slot, its width, offset of the m x width Jacobian in Kkt::J), in the order of
/// Kkt::J.
template <class Visit>
void for_each_jacobian(const KktPattern& pattern, Visit&& visit) {
  for (const KktLink& link : pattern.links) {
    std::size_t at = link.J;
    for (int i = 0; i < link.n_slots; ++i) {
      const auto slot = static_cast<std::size_t>(link.slot[i]);
      visit(link, pattern.first[slot], pattern.width[slot], at);
      at += link.m * pattern.width[slot];
    }
  }
}

/// visit(first unknown of the slot, its width, offset of the width x width block in Kkt::M and Kkt::Minv).
template <class Visit>
void for_each_mass(const KktPattern& pattern, Visit&& visit) {
  for (std::size_t slot = 0; slot < pattern.width.size(); ++slot)
    visit(pattern.first[slot], pattern.width[slot], pattern.M[slot]);
}

/// visit(row, its RowKind as a number), row after row.
template <class Visit>
void for_each_row(const KktPattern& pattern, Visit&& visit) {
  for (const KktLink& link : pattern.links)
    for (int k = 0; k < link.m; ++k) visit(link.first_row + k, static_cast<std::size_t>(kind_of(link, k)));
}

/// y += B x with B the block-diagonal matrix kkt.M or kkt.Minv.
void add_mass_times(const KktPattern&, const std::vector<double>& B, const VecX& x, VecX& y);
/// y += J x, and y -= J^T lambda.
void add_rows_times(const Kkt&, const VecX& x, VecX& y);
void subtract_rows_transposed_times(const Kkt&, const VecX& lambda, VecX& y);
/// The same with absolute values: the size of the product's terms, without cancellation.
void add_sizes_of_mass_times(const KktPattern&, const std::vector<double>& B, const VecX& x, VecX& y);
void add_sizes_of_rows_transposed_times(const Kkt&, const VecX& lambda, VecX& y);
/// s becomes the diagonal of J M^-1 J^T.
void row_diagonal(const Kkt&, VecX& s);

/// x^T B x for one block of B, row-major.
inline double quadratic_form(const double* B, const double* x, int width) {
  double sum = 0.0;
  for (int i = 0; i < width; ++i)
    for (int k = 0; k < width; ++k) sum += x[i] * B[i * width + k] * x[k];
  return sum;
}

/// s gains what those sides of the links add to the diagonal of J M^-1 J^T for which take() holds, in the order of Kkt::J.
template <class S, class Take>
void add_row_diagonal(const Kkt& kkt, S& s, Take&& take) {
  for (const KktLink& link : kkt.pattern.links) {
    std::size_t at = link.J;
    for (int i = 0; i < link.n_slots; ++i) {
      const auto slot = static_cast<std::size_t>(link.slot[i]);
      const int width = kkt.pattern.width[slot];
      const bool takes = take();
      for (int j = 0; j < link.m; ++j, at += static_cast<std::size_t>(width))
        if (takes)
          s[link.first_row + j] += quadratic_form(kkt.Minv.data() + kkt.pattern.M[slot], kkt.J.data() + at, width);
    }
  }
}

}  // namespace lockstep
