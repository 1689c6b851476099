// check_law: holds a law's derivatives against differences of what it says, and looks for jumps that it does not tell.
#pragma once

#include "framework/tools/check/report.h"
#include "framework/mechanism/model/motion_law.h"

namespace lockstep {

/// Over options.from ... options.to, at 8 options.states random instants away from its breakpoints: numbers finite and
/// the same when asked again; the second level the derivative of the first and the third of the second (differences of
/// order 8, tolerance from their own error estimate); jumps outside of breakpoints(), named by their instant. Give the
/// time over which the law does something. `name` for messages; default: its type.
LOCKSTEP_API CheckReport check_law(const MotionLaw&, const CheckOptions& options = {}, const std::string& name = {});
LOCKSTEP_API CheckReport check_law(const TranslationLaw&, const CheckOptions& options = {},
                                   const std::string& name = {});
/// Also: q unit; w = 2 q' qd and a = wd in the moved frame's own axes.
LOCKSTEP_API CheckReport check_law(const RotationLaw&, const CheckOptions& options = {}, const std::string& name = {});

}  // namespace lockstep
