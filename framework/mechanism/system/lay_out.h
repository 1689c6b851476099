// SPDX-License-Identifier: BSD-3-Clause
// Tables of rows some of which are left out.
#pragma once

#include <span>
#include <vector>

#include <lockstep/author/passes.h>

namespace lockstep {

/// As passes::lay_out(), without the rows `absent`: of each link a bit for each of its rows. Links that lose some are gathered
/// by themselves.
LOCKSTEP_API void lay_out_without(std::span<const unsigned> absent, const System&, const std::vector<bool>& modes,
                                  RowTable&);

}  // namespace lockstep
