// SPDX-License-Identifier: BSD-3-Clause
// What rows do to the slots.
#pragma once

#include <array>

#include <lockstep/detail/rows.h>
#include <lockstep/math.h>

namespace lockstep {

/// f <- f - J^T lambda (2.1), 6 per slot: N (world) and N m (slot axes). lambda: one per row of the table.
inline void subtract_reactions(const RowTable& rows, const VecX& lambda, VecX& f) {
  for (const RowEntry& e : rows.entries) {
    const RowView block = rows.block(e);
    for (int i = 0; i < e.slots.n; ++i)
      for (int k = 0; k < e.m; ++k) {
        const std::array<double, 6> J = block.J(i, k);
        for (int c = 0; c < 6; ++c) f[6 * e.slots[i] + c] -= lambda[e.first_row + k] * J[c];
      }
  }
}

}  // namespace lockstep
