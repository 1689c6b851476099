// SPDX-License-Identifier: BSD-3-Clause
// Rows of closures of a tree that moves in a plane: those normal to the plane, which its joints meet at all times.
#pragma once

#include <lockstep/detail/rows.h>
#include <lockstep/system.h>
#include "framework/dynamics/tree/joint_tree.h"

namespace lockstep {

/// Whether rows of a link may have a part that time alone changes.
LOCKSTEP_API bool may_have_laws(const Lock&);
/// Whether those of any of its links may.
LOCKSTEP_API bool may_have_laws(const System&);

/// Leaves the rows that are normal to the plane of a tree out of the table of its closures. False, and the table as it
/// was, if a link does not declare that it stays in the plane, if a row is neither in it nor normal to it at the start,
/// where one that is normal is not met, or where a law may ask for a motion out of it.
bool leave_out_normal_rows(const JointTree&, const System&, RowTable&);

}  // namespace lockstep
