// SPDX-License-Identifier: BSD-3-Clause
// The rows of a mechanism loop by loop: their ranks add up, and each loop is measured by its own size.
#pragma once

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

}  // namespace lockstep
