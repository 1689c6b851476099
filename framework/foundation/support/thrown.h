// What was thrown, in words; for catch blocks around code that is not ours.
#pragma once

#include <exception>
#include <string>

#include <lockstep/export.h>

namespace lockstep {

/// what() of an exception of whatever class; "" where that returns no text at all.
LOCKSTEP_API std::string what_of(const std::exception&);

/// what() and what is nested in it ("no profile: file 'x' is empty"), or the type of what is no exception ("an object
/// of type int, which is no exception"). Null, which std::current_exception() gives for what another language threw, is
/// "something that is no C++ exception".
LOCKSTEP_API std::string thrown_words(const std::exception_ptr&);

}  // namespace lockstep
