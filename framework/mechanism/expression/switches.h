// SPDX-License-Identifier: BSD-3-Clause
// Where the comparisons of a formula switch.
#pragma once

#include <cstddef>
#include <vector>

#include "framework/mechanism/expression/function.h"

namespace lockstep::expression {

/// More switches than these are not looked for.
inline constexpr std::size_t kMostSwitches = 1'000'000;

/// What a search for switches has found.
enum class Found {
  all,
  some,     ///< a term is not told from zero over a span, and between its looks more may hide
  too_many  ///< more than kMostSwitches
};

/// Appends the instants in (t0, t1), in any order, from which on what term `term` itself decides in the formula, which
/// is the last of the terms, is another than just before. `time`: the variable that is the time; the term reads no
/// other.
Found find_switches(const std::vector<Term>&, int term, int time, double t0, double t1, std::vector<double>& out);

}  // namespace lockstep::expression
