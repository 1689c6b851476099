// SPDX-License-Identifier: BSD-3-Clause
// Jumps of a function of time about which nothing is known.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lockstep/author/check.h>
#include "framework/tools/check/slope.h"

namespace lockstep {

/// A function of time whose jumps an object has to report.
struct TimedNumbers {
  Curve at;
  std::function<std::string(int component)> name;
  std::function<void(double t0, double t1, std::vector<double>& out)> breakpoints;
  std::string look;  ///< where they are reported
};

/// The breakpoints() between options.from and options.to, in order; reports errors in them.
std::vector<double> listed_breakpoints(const TimedNumbers&, const CheckOptions&, CheckReport&);
/// Reports jumps outside of the breakpoints; of components that are equal modulo `n_keys`, the first that jumps.
void check_jumps(const TimedNumbers&, const CheckOptions&, CheckReport&, int cells, int n_keys);

}  // namespace lockstep
