// SPDX-License-Identifier: BSD-3-Clause
// The machine on which a report is made, in words.
#pragma once

#include <string>

#include <lockstep/detail/export.h>

namespace lockstep::report {

/// "Linux x86_64, Intel(R) Xeon(R) CPU @ 2.80GHz, 8 processors": system, processor as far as it is known, and how many.
std::string machine_words();

/// "lockstep 0.2.0, 2026-03-01, Linux x86_64, ...": version, today's date (UTC) and machine, for pictures of what was
/// measured.
LOCKSTEP_API std::string measured_words();

}  // namespace lockstep::report
