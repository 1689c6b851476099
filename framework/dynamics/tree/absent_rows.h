// Rows that are taken out of a table of closures.
#pragma once

#include <span>

#include <lockstep/rows.h>

namespace lockstep {

/// Takes rows out of a table of a mechanism in space: `absent`, a bit for each row of an entry. Links that lose some are
/// gathered by themselves.
void take_out(std::span<const unsigned> absent, RowTable&);

}  // namespace lockstep
