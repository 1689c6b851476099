// What a terminal shows that a file does not: colour.
#pragma once

namespace lockstep {

/// "lockstep:", what an error on standard error begins with; red on a terminal, unless NO_COLOR is set.
const char* error_mark();

}  // namespace lockstep
