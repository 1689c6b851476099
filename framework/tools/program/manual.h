// SPDX-License-Identifier: BSD-3-Clause
// The manual page of the program, written from its commands and options.
#pragma once

#include <string>

#include "framework/tools/program/options.h"

namespace lockstep {

/// What `lockstep --help` ends with.
inline constexpr const char* kExitCodes =
    "0 done; 2 command line, 3 scene, 4 plugin or its code, 5 start off the constraints, 6 a step that cannot be "
    "made, 7 a number that is not finite, 8 file; 9 the run went through, but its energy balance or its drift is "
    "beyond the limits (energy_limit, violation_limit); 10 out of memory; 11 a doubtful result (run --strict), or a "
    "start far from the one given (assemble); 130 interrupted; 1 any other failure";

/// Its part on the commands of a program, but for one that stands in for lockstep's own.
std::string commands_page(const Program&);

}  // namespace lockstep
