// SPDX-License-Identifier: BSD-3-Clause
// The check of the dimensions of a formula, as types with formulas make it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/mechanism/expression/scope.h"

namespace lockstep::testing {

/// A variable of a formula; without a dimension: not known.
struct MeasuredVariable {
  std::string name;
  std::optional<Dimension> dimension{};
};

inline void check_dimensions(const std::string& formula, const std::vector<MeasuredVariable>& variables,
                             const std::vector<NamedNumbers>& constants, const std::optional<Dimension>& value) {
  std::vector<std::string> names;
  expression::Scope scope;
  for (const MeasuredVariable& v : variables) {
    scope.add(v.name, static_cast<int>(names.size()), v.dimension);
    names.push_back(v.name);
  }
  scope.add(constants);
  scope.check(expression::Expression(formula, names), value);
}

}  // namespace lockstep::testing
