// The measured orders of an integrator on a motion with a closed form.
#pragma once

#include <lockstep/author/check.h>
#include "framework/tools/check/closed_motion.h"

namespace lockstep {

/// The order against the step; of an adaptive method against its mean step, and the error against the tolerance.
void check_order(const IntegratorMaker&, const IntegratorInfo&, const ClosedMotion&, CheckReport&);
/// The dense output of one step from the exact start: its ends, and how its error falls inside.
void check_dense_output(const IntegratorMaker&, const ClosedMotion&, CheckReport&);

}  // namespace lockstep
