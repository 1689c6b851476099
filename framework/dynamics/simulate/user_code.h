// SPDX-License-Identifier: BSD-3-Clause
// How the code of events, observers, channels and progress is called in a run. Internal to the step loop.
#pragma once

#include <cstddef>
#include <string>
#include <typeinfo>

#include <lockstep/error.h>

namespace lockstep {

class Observer;

/// Calls `act` and returns its result. What it throws gets the name of the thing and the time, by rethrow_in().
template <class Act>
decltype(auto) user_code(const char* kind, const std::string& name, double t, Act&& act) {
  return in_context([&] { return ErrorContext{.thing = {.kind = kind, .name = name}, .t = t}; },
                    static_cast<Act&&>(act));
}

/// In a catch block: what an observer, the `number`-th of its run from 0, or a function of the loop's threw gets its name
/// and the time. Errors of lockstep's own are what they are: a file that cannot be written.
[[noreturn]] void rethrow_of_observer(const Observer&, std::size_t number, double t);
[[noreturn]] void rethrow_of_function(const char* kind, const std::type_info& function, double t);

/// Calls `act`, code of that observer.
template <class Act>
void observer_code(const Observer& observer, std::size_t number, double t, Act&& act) {
  try {
    act();
  } catch (...) {
    rethrow_of_observer(observer, number, t);
  }
}

/// Calls a function that the host has set, progress or between_steps, and returns its result.
template <class Function, class... Args>
decltype(auto) function_code(const char* kind, const Function& function, double t, const Args&... args) {
  try {
    return function(args...);
  } catch (...) {
    rethrow_of_function(kind, function.target_type(), t);
  }
}

}  // namespace lockstep
