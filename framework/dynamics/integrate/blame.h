// Who is to blame for what came out of an evaluation or a step.
#pragma once

#include "framework/dynamics/integrate/integrator.h"

namespace lockstep {

/// In a catch block around an integrator's code: what is no Error becomes UserCodeError that names the method and the
/// time, with the original nested in it. So does an Error of a plugin's method, but for those that name their maker
/// already or say what no step can mend; a StepError and a ModelError keep their type.
[[noreturn]] LOCKSTEP_API void rethrow_named(const Integrator&, double t);

/// Runs `act`, which calls the method's code, and returns what it returns.
template <class Act>
auto named(const Integrator& method, double t, Act&& act) -> decltype(act()) {
  try {
    return act();
  } catch (...) {
    rethrow_named(method, t);
  }
}

}  // namespace lockstep
