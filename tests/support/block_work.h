// SPDX-License-Identifier: BSD-3-Clause
// The multiplications of a factorisation in blocks, counted from its plan.
#pragma once

#include "framework/dynamics/solvers/block_plan.h"

namespace lockstep::test {

/// Of a pivot of width w: its triangles, W and Z of each later node, and the block of each pair of those.
inline long multiplications(const BlockPlan& plan) {
  const bool half = plan.symmetric;
  long sum = 0;
  for (const BlockPlan::Node& pivot : plan.nodes) {
    const long w = pivot.width;
    sum += half ? w * (w + 1) * (w + 2) / 6 : w * w * w / 3 + w;
    for (int b = 0; b < pivot.n_later; ++b) {
      const long w_b = plan.later[pivot.first_later + b].width;
      sum += (half ? 1 : 2) * w * (w + 1) / 2 * w_b;
      for (int a = 0; a <= b; ++a) sum += (half || a == b ? 1 : 2) * w * plan.later[pivot.first_later + a].width * w_b;
    }
  }
  return sum;
}

}  // namespace lockstep::test
