// SPDX-License-Identifier: BSD-3-Clause
// Jumps of a function of time about which nothing is known.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <lockstep/author/check.h>
#include "framework/tools/check/slope.h"

namespace lockstep {

/// A component changes by `size` at the instant t, which is known to about 1e-9 of the interval.
struct Jump {
  double t = 0;
  double size = 0;
};

/// Jumps of each component of f inside (t0, t1), in order of time, more than 1e-9 of the interval away from the
/// instants `known`. Each of `cells` cells is bisected, always into the half in which f departs most from the mean of
/// its ends: what does not vanish is a jump. Finds jumps of more than 1e-6 of the component's size (which counts as at
/// least 1e-10 of the largest component's); of several in one cell, the largest.
LOCKSTEP_API std::map<int, std::vector<Jump>> find_jumps(const Curve& f, double t0, double t1,
                                                         std::vector<double> known, int cells);

/// A function of time whose jumps an object has to tell.
struct TimedNumbers {
  Curve at;
  std::function<std::string(int component)> name;
  std::function<void(double t0, double t1, std::vector<double>& out)> breakpoints;
  std::string look;  ///< where they are told
};

/// What breakpoints() tells between options.from and options.to, in order; reports what is wrong in that.
std::vector<double> told_breakpoints(const TimedNumbers&, const CheckOptions&, CheckReport&);
/// Reports the jumps that are not told; of components that are equal modulo `n_keys`, the first that jumps.
void check_jumps(const TimedNumbers&, const CheckOptions&, CheckReport&, int cells, int n_keys);

}  // namespace lockstep
