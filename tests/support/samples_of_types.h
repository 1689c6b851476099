// SPDX-License-Identifier: BSD-3-Clause
// Parameters for every type of the library, so that tests can make one of each. A type without an example is made from
// its defaults.
#pragma once

#include <string>

#include <lockstep/author/params.h>
#include "framework/description/scene/describe.h"
#include "framework/description/scene/json.h"

namespace lockstep {

/// `kind`: "link", "law", "translation law", "rotation law", "force".
inline Params sample_params(const std::string& kind, const std::string& type) {
  const std::string keys = example_keys(kind, type);
  return keys == "{}" ? Params{} : Params::unchecked(read_json(keys, "sample of " + type));
}

/// How many marker pairs the sample of a link type takes.
inline int sample_pairs(const std::string& type) { return example_pairs(type); }

}  // namespace lockstep
