// SPDX-License-Identifier: BSD-3-Clause
// The manual page of the program, written from its commands and options.
#pragma once

#include <string>

#include "framework/tools/program/options.h"

namespace lockstep {

/// The exit codes, for `lockstep --help` and the manual.
inline constexpr const char* kExitCodes =
    "    0  done\n"
    "    1  any other failure\n"
    "    2  invalid command line\n"
    "    3  invalid scene\n"
    "    4  a plugin, or its code\n"
    "    5  the start, or a jump of a law, does not fit the constraints\n"
    "    6  a step or solution cannot be computed\n"
    "    7  a number is not finite\n"
    "    8  a file that cannot be read or written\n"
    "    9  complete; energy error or constraint violation beyond its limit (energy_limit, violation_limit)\n"
    "   10  out of memory\n"
    "   11  complete; doubtful result (--strict, --certify), or start far from the one given (assemble)\n"
    "  130  interrupted";

/// Its part on the commands of a program, without one that replaces a command of lockstep.
std::string commands_page(const Program&);

}  // namespace lockstep
