// SPDX-License-Identifier: BSD-3-Clause
// The units that laws are written in, against those of what they drive.
#pragma once

#include <string>

#include <lockstep/author/params.h>

namespace lockstep {

class Registry;

/// What the values of a law are: of the dimension `unit` per second^`per_second`. Without `of_time` its argument is no
/// time, and its rates are not checked.
struct LawDimension {
  Unit unit = Unit::none;
  int per_second = 0;
  bool of_time = true;
};

/// Throws SceneError, with the place of the text and `owner`, if a law or one of its parts has a unit of another
/// dimension: a slope of "3 m/s" in a law of an angle. `form`: of the key that holds the law.
LOCKSTEP_API void check_law_units(const Value& law, Form form, LawDimension, const Registry&, const std::string& owner);

/// Throws SceneError if the text of a key of Unit::any has a unit of another dimension than `unit` per
/// second^`per_second`.
LOCKSTEP_API void check_unit(const Params&, const std::string& key, Unit unit, int per_second = 0);

/// Checked parameters with the laws among them made, as by checked_params().
LOCKSTEP_API Params with_laws(Params, const Registry* laws);

}  // namespace lockstep
