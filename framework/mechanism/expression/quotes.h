// SPDX-License-Identifier: BSD-3-Clause
// Names in quotes: a formula of channels keeps the quotes, as 'P.x' is a channel even if a point is called P.
#pragma once

#include <string>

namespace lockstep::expression {

inline std::string without_quotes(const std::string& name) {
  return name.starts_with('\'') ? name.substr(1, name.size() - 2) : name;
}

}  // namespace lockstep::expression
