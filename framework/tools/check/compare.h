// SPDX-License-Identifier: BSD-3-Clause
// Declared derivatives against differences: the rule that all checks have.
#pragma once

#include <functional>
#include <string>

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

}  // namespace lockstep
