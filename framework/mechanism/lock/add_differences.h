// SPDX-License-Identifier: BSD-3-Clause
// Tangents of joints and forces without formulas for them.
#pragma once

#include <algorithm>
#include <span>

#include <lockstep/detail/rows.h>

namespace lockstep {

/// Adds K, and D if `velocities`, by central differences over these slots of the force that push(inputs, f) adds to f, 6
/// numbers per slot.
template <class Push>
void add_differences(std::span<const int> slots, bool velocities, const Inputs& in, TangentSum& out, const Push& push) {
  if (slots.empty()) return;
  Differences& scratch = out.differences(in);
  Inputs at = in;
  at.motions = scratch.motions;
  const auto add_force = [&](int column, int k, double factor) {
    for (const int i : slots) scratch.f.segment<6>(6 * i).setZero();
    push(at, scratch.f);
    for (const int i : slots) {
      Mat6 change = Mat6::Zero();
      change.col(k % 6) = factor * scratch.f.segment<6>(6 * i);
      if (k < 6)
        out.add_K(i, column, change);
      else
        out.add_D(i, column, change);
    }
  };
  const double distance = Differences::distance(slots, in);
  for (const int j : slots)
    for (int k = 0; k < (velocities ? 12 : 6); ++k) {
      Motion& O = scratch.motions[j + 1];
      const Motion home = O;
      const double speed = std::max(1.0, k < 9 ? home.v.norm() : home.w.norm());
      const double h = Differences::kStep * (k < 3 ? distance : k < 6 ? 1.0 : speed);
      O = Differences::moved(home, k, h);
      add_force(j, k, -0.5 / h);
      O = Differences::moved(home, k, -h);
      add_force(j, k, 0.5 / h);
      O = home;
    }
}

}  // namespace lockstep
