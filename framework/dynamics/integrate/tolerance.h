// Which tolerances a run may ask for.
#pragma once

#include <lockstep/export.h>
#include <lockstep/integrator.h>

namespace lockstep {

/// Refuses a tolerance that is not above zero, that no number of 16 digits meets, or that allows any error. Throws
/// ModelError.
LOCKSTEP_API void check_tolerance(const Tolerance&);

/// This relative tolerance, and a hundredth of it as the absolute one, checked.
LOCKSTEP_API Tolerance tolerance_of(double relative);

}  // namespace lockstep
