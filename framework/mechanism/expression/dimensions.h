// SPDX-License-Identifier: BSD-3-Clause
// Formulas of variables held against the dimensions of what they read and of what they drive.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <lockstep/detail/export.h>
#include "framework/mechanism/expression/function.h"

namespace lockstep::expression {

/// A variable of a formula.
struct MeasuredVariable {
  std::string name;
  std::optional<Dimension> dimension{};  ///< nothing: not known here
};

/// Checks a formula that has a unit, or a constant that was given with one; all others are of numbers in SI. The
/// formula has been compiled with these variables and constants. `value`: the dimension of what takes its value, if that
/// is known. The radian counts as 1, a written 0 is of every dimension, a plain number that is a factor of what varies too (3 in
/// L sin(3 t)), and what variables and plain numbers make without a unit is in SI. Nothing is checked if a variable of unknown dimension is
/// read. Throws ModelError with the formula, the column and both dimensions.
LOCKSTEP_API void check_dimensions(const std::string& formula, const std::vector<MeasuredVariable>& variables,
                                   const std::vector<Constant>& constants, const std::optional<Dimension>& value);

}  // namespace lockstep::expression
