// SPDX-License-Identifier: BSD-3-Clause
// Messages on standard error, and colour on a terminal.
#pragma once

#include <string>
#include <string_view>

#include <lockstep/error.h>

namespace lockstep {

/// Writes to standard error. If that cannot be written, as after the end of its terminal, the words are lost; no error
/// is thrown.
void tell(std::string_view words);

/// "error:", the beginning of an error on standard error; red on a terminal, unless NO_COLOR is set.
const char* error_mark();
/// The sentence of an error; the advice about a start or a motion is a line of its own, "  hint: ".
std::string in_lines(const Error&);
/// Writes an error to standard error. A sentence of several lines is several errors; indented lines belong to the one
/// before.
void tell_error(std::string_view sentence);

}  // namespace lockstep
