// SPDX-License-Identifier: BSD-3-Clause
// Rows that become dependent on others in one position alone.
#pragma once

#include <string>
#include <vector>

#include <lockstep/dynamics.h>

namespace lockstep {

/// Names of the links whose rows become dependent from a regular position to a singular one: those that take part in the
/// combination of rows which fades, loop by loop. None if a loop has more than 300 rows, or no row fades.
std::vector<std::string> fading_links(System&, const State& regular, const State& singular);

}  // namespace lockstep
