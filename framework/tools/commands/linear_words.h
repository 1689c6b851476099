// SPDX-License-Identifier: BSD-3-Clause
// What the verbs modes, linearize and matrices share: their options, and words on the state.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <lockstep/linearization.h>
#include "framework/tools/program/commands.h"

namespace lockstep {

/// --spin and --frozen. Throws UsageError.
LinearMotionOptions motion_options(const Arguments&);

/// Lines on the instant, the axes, the unrest, and what was held.
std::string state_words(double t, const Vec3& spin, const Unrest&, const std::vector<Finding>& notes);
/// The same as data.
nlohmann::ordered_json state_json(const Vec3& spin, const Unrest&, const std::vector<Finding>& notes);

/// Adds to a ModelError which options of the program are the next move.
[[noreturn]] void rethrow_with_options(const ModelError&);

/// Calls an analysis whose errors speak of the program's options.
template <class Analysis>
auto with_words_of_program(Analysis&& analysis) {
  try {
    return analysis();
  } catch (const ModelError& error) {
    rethrow_with_options(error);
  }
}

}  // namespace lockstep
