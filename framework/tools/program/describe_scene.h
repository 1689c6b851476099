// SPDX-License-Identifier: BSD-3-Clause
// The meaning of a name of a scene.
#pragma once

#include <string>
#include <vector>

#include <lockstep/scene.h>

namespace lockstep {

/// A parameter or point of a scene.
struct ParameterFacts {
  std::string name, kind,              ///< "parameter" or "point"
      value,                           ///< in SI units: "0.1 m"
      written,                         ///< as the scene gives it: "100 mm"
      where;                           ///< "four_bar.json:5:16"
  bool is_own = true;                  ///< whether it stands in this file itself, and in no included or repeated part
  std::vector<std::string> read_by{};  ///< paths of the values of this file that depend on it directly
};

/// Of the parameter or point of this name. Throws UsageError with the closest name.
ParameterFacts parameter_facts(const Scene&, const std::string& name);

/// The options that change it: components of a vector vary, and a formula sets all of it.
std::string ways_to_change(const ParameterFacts&);

/// A computed value in words: "0.1 m", "[0.1, 0, 0] m". `brief`: in six digits.
std::string value_words(const Value&, bool brief = false);

}  // namespace lockstep
