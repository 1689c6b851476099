// SPDX-License-Identifier: BSD-3-Clause
// Messages on standard error, and colour on a terminal.
#pragma once

#include <string_view>

namespace lockstep {

/// Writes to standard error. If that cannot be written, as after the end of its terminal, the words are lost; no error
/// is thrown.
void tell(std::string_view words);

/// "error:", the beginning of an error on standard error; red on a terminal, unless NO_COLOR is set.
const char* error_mark();
/// Writes an error to standard error. A sentence of several lines is several errors; indented lines belong to the one
/// before.
void tell_error(std::string_view sentence);

}  // namespace lockstep
