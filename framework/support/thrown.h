// What was thrown, in words; for catch blocks around code that is not ours.
#pragma once

#include <exception>
#include <string>

#include "framework/support/export.h"

namespace lockstep {

/// what() and what is nested in it ("no profile: file 'x' is empty"), or the type of what is no exception ("an object
/// of type int, which is no exception").
LOCKSTEP_API std::string thrown_words(const std::exception_ptr&);

}  // namespace lockstep
