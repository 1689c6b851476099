// SPDX-License-Identifier: BSD-3-Clause
// Descriptions of thrown objects, for catch blocks around user code.
#pragma once

#include <exception>
#include <new>
#include <string>
#include <typeinfo>

#include <lockstep/detail/export.h>

namespace lockstep {

/// what(), or "" where it returns null.
LOCKSTEP_API std::string what_of(const std::exception&);

/// what() with the exceptions nested in it ("no profile: file 'x' is empty"), or the type of anything else ("an object
/// of type int, which is not an exception"). Null, which std::current_exception() returns for an exception of another
/// language, gives "something that is not a C++ exception".
LOCKSTEP_API std::string thrown_words(const std::exception_ptr&);

/// What an action throws; null: nothing.
template <class Act>
std::exception_ptr thrown_by(Act&& act) {
  try {
    act();
    return nullptr;
  } catch (...) {
    return std::current_exception();
  }
}

/// Runs an action; false if it throws. What it throws is dropped, except that memory is short, which is passed on.
template <class Act>
bool succeeds(Act&& act) {
  try {
    act();
    return true;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (...) {
    return false;
  }
}

/// "Highest", of a class as its author wrote it.
LOCKSTEP_API std::string type_words(const std::type_info&);

/// Whether a class, or a function object, was written in namespace lockstep.
LOCKSTEP_API bool is_of_lockstep(const std::type_info&);

}  // namespace lockstep
