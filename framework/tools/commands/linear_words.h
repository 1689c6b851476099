// SPDX-License-Identifier: BSD-3-Clause
// Options and state of the commands modes and linearize.
#pragma once

#include <memory>

#include <lockstep/linearization.h>
#include "framework/tools/analysis/linear_inputs.h"
#include "framework/tools/commands/state_at.h"
#include "framework/tools/program/options.h"

namespace lockstep {

/// The options of both.
Options motion_command_options();
/// --spin and --frozen. Throws UsageError.
LinearMotionOptions motion_options(const Arguments&);
/// --at: the state to which a mechanism is run; with --equilibrium the static equilibrium that is found from there.
MechanismAt motion_state(std::unique_ptr<Mechanism>, const Registry&, const Arguments&);

/// The state of an analysis.
struct StateFound {
  double t;
  Vec3 spin;
  Unrest unrest;
};
/// t, and "state": spin, residual motion.
const Fields<StateFound>& state_fields();

/// The next move in the program, for with_advice().
inline constexpr const char* kAdvice =
    "\n  hint: --equilibrium takes the static equilibrium (lockstep statics prints it), --at T another time,"
    "\n  --spin X,Y,Z a steady rotation, --frozen this state";

}  // namespace lockstep
