// SPDX-License-Identifier: BSD-3-Clause
// What is wrong with a mechanism whose start or run fails, as facts about it: loops that cannot close, drives that
// contradict, joints that lock, limit positions, steps that are too long.
#pragma once

#include <limits>
#include <string>

#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/step_loop.h>

namespace lockstep {

/// A fact about a mechanism, and what to do about it; both empty if there is none.
struct Cause {
  std::string fact, hint;
  bool possible = false;  ///< it may have another cause: the error's advice is kept
  Error::Kind kind = Error::Kind::other;  ///< assembly or step: of the error that is thrown; other: of that it explains
  double t = std::numeric_limits<double>::quiet_NaN();  ///< simulated time, s
};

/// What is wrong with a start that cannot be assembled. `given`: the start as it was given.
LOCKSTEP_API Cause cause_of_start(Dynamics&, const State& given);
/// Why a run cannot continue from a state on its constraints. `step`: fixed_step(), s.
LOCKSTEP_API Cause cause_of_stop(Dynamics&, const State& at, double step);
/// The length of the steps that a run makes, which its outputs may cut, s; 0: the method chooses it. `step`: of its settings.
LOCKSTEP_API double fixed_step(StepLoop&, double step);
/// That its joints leave a driven mechanism no degree of freedom.
LOCKSTEP_API Cause cause_of_lock(Dynamics&, const State& at);

/// Throws the error again: the cause, its hint, these further lines, and the error's own sentence last; without a cause
/// the sentence first. Errors that no mechanism causes are thrown as they are.
[[noreturn]] LOCKSTEP_API void rethrow_with(const Cause&, const Error&, const std::string& lines = {});

}  // namespace lockstep
