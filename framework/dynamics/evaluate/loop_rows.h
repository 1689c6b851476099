// SPDX-License-Identifier: BSD-3-Clause
// The rows of a mechanism loop by loop: their ranks add up, and each loop is measured by its own size.
#pragma once

#include <span>
#include <vector>

#include <lockstep/dynamics.h>
#include "framework/foundation/math/sparse.h"

namespace lockstep {

/// Entries of the table in groups whose ranks add up: those that lie on common loops of slots.
LOCKSTEP_API std::vector<std::vector<int>> loops_of(const System&, const RowTable&);
/// Without those of a single joint, whose rows depend on no others.
LOCKSTEP_API std::vector<std::vector<int>> closed_loops(const System&, const RowTable&);

/// Jacobian, transposed, of some entries: a row is a column, entry after entry; of each slot that they touch six numbers.
/// Turns are lengths, by the size of the loop, or by the radius of gyration of the slot if that is larger. So what moves
/// elsewhere does not change what nearly depends.
LOCKSTEP_API SparseMat rows_of_loop(const System&, const RowTable&, const std::vector<int>& entries);

/// The sizes of the loops of links in these modes.
class LOCKSTEP_API LoopSizes {
 public:
  LoopSizes() = default;
  LoopSizes(const System&, const std::vector<bool>& modes);
  /// Of the largest loop of a slot, m, or its radius of gyration if that is larger.
  double length(int slot) const { return lengths_[slot]; }
  /// Whether all of C, rows of these links, is what rounding leaves: by the size of their loop, and by how far its slots
  /// are from the origin. Projected where rows nearly depend, it would move the state. `motions`: ground, then slots.
  bool are_met(const RowTable&, const VecX& C, std::span<const Motion> motions) const;
  /// The same of J v + Ct: by the speed of the slots of the loop.
  bool are_rates_met(const RowTable&, const VecX& Cd, std::span<const Motion> motions) const;

 private:
  struct Loop {
    double length = 0;
    std::vector<int> slots;
  };
  template <class Rounding>  // of a loop, m or m/s
  bool within(const RowTable&, const VecX& c, Rounding&&) const;

  std::vector<Loop> loops_;
  std::vector<std::size_t> loop_of_;  // of each link the largest that it is part of
  std::vector<double> lengths_;
};

}  // namespace lockstep
