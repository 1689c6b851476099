// SPDX-License-Identifier: BSD-3-Clause
// Tables as CSV, with units in the titles or without.
#pragma once

#include <cstddef>
#include <string>

#include <lockstep/table.h>

namespace lockstep {

/// Appends the header, with its line end: `t [s],Bx [N]`, or without units `t,Bx`.
LOCKSTEP_API void append_csv_header(std::string& text, const Table&, bool units = true);
/// Appends row i, with its line end.
LOCKSTEP_API void append_csv_row(std::string& text, const Table&, std::size_t i);

}  // namespace lockstep
