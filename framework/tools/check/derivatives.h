// SPDX-License-Identifier: BSD-3-Clause
// A quick check of functions that a host brings, when their scene is read.
#pragma once

#include <functional>

#include <lockstep/system.h>

namespace lockstep {

/// What to do about a wrong derivative, in the host's words.
struct DerivativeAdvice {
  const char *law, *joint;
};

/// Throws ModelError if a law that moves a joint or a marker has rates, or a joint of which `is_own` derivatives, that
/// differ from finite differences of its values. `until`: end of the time in which laws are called, s, if it is above 0.
LOCKSTEP_API void refuse_wrong_derivatives(System&, double until, const std::function<bool(const Lock&)>& is_own,
                                           const DerivativeAdvice&);

}  // namespace lockstep
