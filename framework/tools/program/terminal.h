// SPDX-License-Identifier: BSD-3-Clause
// What the program says on standard error, and what a terminal shows that a file does not: colour.
#pragma once

#include <string_view>

namespace lockstep {

/// Writes to standard error. Where that cannot be written, as after the end of its terminal, the words are lost and
/// nothing else is: no error is thrown.
void tell(std::string_view words);

/// "lockstep:", what an error on standard error begins with; red on a terminal, unless NO_COLOR is set.
const char* error_mark();

}  // namespace lockstep
