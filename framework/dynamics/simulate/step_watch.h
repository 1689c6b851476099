// SPDX-License-Identifier: BSD-3-Clause
// Checks of each step by the step loop, independent of the report of the method. Internal to the step loop.
#pragma once

#include <lockstep/author/integrator.h>
#include <lockstep/system.h>

namespace lockstep {

/// Checks the step of at most h, s, from `from` to `to`: time, finite numbers, unit quaternions. Of a method that is not
/// built in also what it must not touch. Throws StepError that names the method.
void check_step(const System&, const Integrator&, const State& from, const State& to, double h, const StepReport&);

/// Measures |C| at the end of the n-th step of a run, of which the larger one is reported: in each step of a method that is
/// not built in, else in steps 1, 2, 4 and 8 and in every 16th, at less than the cost of an evaluation.
void measure_violation(Dynamics&, const Integrator&, const State& at, long n, StepReport&);

}  // namespace lockstep
