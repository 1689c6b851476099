// SPDX-License-Identifier: BSD-3-Clause
// The lines of a text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <lockstep/detail/export.h>

namespace lockstep {

/// The parts of a text that end with `end`, or at its end. Throws std::bad_alloc, where a stream would end early.
LOCKSTEP_API std::vector<std::string> lines_of(std::string_view text, char end = '\n');
inline std::string first_line(std::string_view text) { return std::string(text.substr(0, text.find('\n'))); }

}  // namespace lockstep
