// How the code of events, observers and progress is called in a run. Internal to the step loop.
#pragma once

#include <new>
#include <string>

#include <lockstep/error.h>

namespace lockstep {

/// Calls `act` and returns its result. What it throws gets the name of the thing and the time; what is no Error becomes
/// a UserCodeError, but for a lack of memory.
template <class Act>
decltype(auto) user_code(const char* kind, const std::string& name, double t, Act&& act) {
  try {
    return act();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (...) {
    rethrow_in({.thing = {.kind = kind, .name = name}, .t = t});
  }
}

}  // namespace lockstep
