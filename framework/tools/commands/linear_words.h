// SPDX-License-Identifier: BSD-3-Clause
// What the commands modes and linearize share: their options, and the state.
#pragma once

#include <lockstep/linearization.h>
#include "framework/tools/program/options.h"

namespace lockstep {

/// What both take.
Options motion_command_options();
/// --spin and --frozen. Throws UsageError.
LinearMotionOptions motion_options(const Arguments&);

/// The state of an analysis.
struct StateFound {
  double t;
  Vec3 spin;
  Unrest unrest;
};
/// t, and "state": spin, unrest.
const Fields<StateFound>& state_fields();

/// Calls an analysis whose errors say which options of the program are the next move.
template <class Analysis>
auto with_words_of_program(Analysis&& analysis) {
  try {
    return analysis();
  } catch (const ModelError& error) {
    const std::string words = error.what();
    if (words.find("neither an equilibrium") == std::string::npos) throw;
    throw ModelError(words + " (--at T another instant, --spin x,y,z the turning of the axes, --frozen this one)");
  }
}

}  // namespace lockstep
