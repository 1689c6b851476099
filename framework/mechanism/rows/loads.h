// SPDX-License-Identifier: BSD-3-Clause
// What rows do to the slots.
#pragma once

#include <array>

#include <lockstep/detail/rows.h>
#include <lockstep/math.h>

namespace lockstep {

/// visit(row, slot, its six numbers of J), entry by entry, slot by slot, row by row.
template <class Visit>
void for_each_jacobian(const RowTable& rows, Visit&& visit) {
  for (const RowEntry& e : rows.entries) {
    const RowView block = rows.block(e);
    for (int i = 0; i < e.slots.n; ++i)
      for (int k = 0; k < e.m; ++k) {
        const std::array<double, 6> J = block.J(i, k);
        visit(e.first_row + k, e.slots[i], Eigen::Map<const Vec6>(J.data()));
      }
  }
}

/// f <- f - J^T lambda (2.1), 6 per slot: N (world) and N m (slot axes). lambda: one per row of the table.
inline void subtract_reactions(const RowTable& rows, const VecX& lambda, VecX& f) {
  for_each_jacobian(rows, [&](int row, int slot, const auto& J) { f.segment<6>(6 * slot) -= lambda[row] * J; });
}

}  // namespace lockstep
