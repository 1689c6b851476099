// SPDX-License-Identifier: BSD-3-Clause
// The rules that all checks have: declared derivatives against differences, and jumps of a function of time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lockstep/author/check.h>
#include "framework/foundation/math/limits.h"
#include "framework/tools/check/slope.h"

namespace lockstep {

inline constexpr double kRounding = 1e-10;  ///< of a number, as a part of its size

/// Numbers that an object reports, component by component.
struct Declared {
  std::string key;                       ///< of the findings, with the number of the component
  VecX is;                               ///< the numbers
  VecX size;                             ///< in addition to their own, by which rounding counts
  std::function<std::string(int)> what;  ///< "yd at t = 1 s"
  std::string source;                    ///< what the differences are of: "differences of y give"
  std::string where;                     ///< " (seed 7, state 3)"
  std::function<std::string(int)> look;  ///< where to look for the cause
  double rounding = kRounding;
  int kind = 1;  ///< so many components have one key
};

/// Whether `act` returns; code of the checked object that throws is a finding, with the state if `where` gives it.
bool completes(CheckReport&, const std::function<void()>& act, const std::function<std::string()>& where = {});

/// Compares each with differences. A finding is a difference beyond their error and rounding; whether there is.
bool compare(CheckReport&, const Declared&, const Slope&);

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
