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
  Error::Kind kind = Error::Kind::other;  ///< assembly or step: of the error that is thrown; other: of that it explains
  double t = std::numeric_limits<double>::quiet_NaN();  ///< simulated time, s
  bool found() const { return !fact.empty(); }
};

/// What is wrong with a start that cannot be assembled. `given`: the start as it was given.
LOCKSTEP_API Cause cause_of_start(Dynamics&, const State& given);
/// Why no motion continues from a state on its constraints.
LOCKSTEP_API Cause cause_of_stop(Dynamics&, const State& at);
/// Advice on hinges: two of the same bodies with parallel axes apart, or one whose axis is not parallel to those of all
/// others, which are; else "".
LOCKSTEP_API std::string odd_axis(Dynamics&, const State&);
/// That its joints leave a driven mechanism no degree of freedom.
LOCKSTEP_API Cause cause_of_lock(Dynamics&, const State& at);

/// Throws the error again: the cause, its hint, these further lines, and the error's own sentence last; without a cause
/// the sentence first. Errors that no mechanism causes are thrown as they are.
[[noreturn]] LOCKSTEP_API void rethrow_with(const Cause&, const Error&, const std::string& lines = {});

/// The same, with the cause of a run that began at `started` and stopped by this error. `step`: of its settings, s; unused
/// if the method chooses its steps.
[[noreturn]] LOCKSTEP_API void rethrow_of_run(System&, StepLoop&, const State& started, double step, const Error&,
                                              const std::string& lines = {});

}  // namespace lockstep
