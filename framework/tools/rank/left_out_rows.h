// SPDX-License-Identifier: BSD-3-Clause
// Rows that are left out, and whether they hold when the mechanism has moved on without them.
#pragma once

#include <optional>
#include <vector>

#include <lockstep/dynamics.h>
#include "framework/tools/rank/loop_rows.h"

namespace lockstep {

/// Whether the rows of the active links are few enough to be held down to the smallest, for which they are factored
/// densely: 300, in a plane those of the plane, and those that are left out too.
bool are_few_rows(const System&, const std::vector<bool>& modes);

/// Leaves rows out, in addition to those that are.
void leave_out(System&, const std::vector<NamedRow>&);
/// Leaves out the rows of drives, too.
void release_drives(System&);
/// Puts all rows that were left out back, and revokes the decision to keep nearly dependent rows.
void take_back(System&);

/// Of rows that are left out, on poses without them, m; HUGE_VAL if the mechanism stops on its way there.
struct Violation {
  double most = 0,  ///< the largest, rotations times System::length()
      gap = 0;      ///< the largest of a translation
};
/// That of `rows`: along what each of them held, the mechanism moves on without its drives by 0.3 rad, or the same part
/// of System::length(). None if other rows hold what they hold. They are left out as long as it looks.
std::optional<Violation> violation_without(System&, Dynamics&, const State&, const std::vector<NamedRow>& rows,
                                           const std::vector<NamedRow>& all_left_out);

}  // namespace lockstep
