// SPDX-License-Identifier: BSD-3-Clause
// Options and state of the commands modes and linearize.
#pragma once

#include <memory>

#include <lockstep/linearization.h>
#include "framework/foundation/math/limits.h"
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
inline const Fields<Unrest> kUnrestFields{
    {"still", "", "at rest there", &Unrest::is_still},
    {"acceleration", "m/s^2", "residual acceleration", &Unrest::acceleration,
     [](const Json& a) { return a < kRoundOff ? std::string("0 m/s^2") : number_text(a) + " m/s^2"; }},
    {"acceleration_limit", "m/s^2", "  limit", &Unrest::acceleration_limit, json_only},
    {"accelerates", "", "  of", &Unrest::accelerates, json_only},
    {"speed", "m/s", "residual speed", &Unrest::speed},
    {"speed_limit", "m/s", "  limit", &Unrest::speed_limit, json_only},
    {"moves", "", "  of", &Unrest::moves, json_only}};
inline const Fields<StateFound> kMotionFields =
    Fields<StateFound>{{"spin", "rad/s", "spin of the axes", &StateFound::spin}}.with(&StateFound::unrest,
                                                                                      kUnrestFields);
/// t, and "state": spin, residual motion.
inline const Fields<StateFound> kStateFields{{"t", "s", "t", &StateFound::t},
                                             {"state", "state", std::identity(), kMotionFields}};

/// The next move in the program, for with_advice().
inline constexpr const char* kAdvice =
    "\n  hint: --equilibrium takes the static equilibrium (lockstep statics prints it), --at T another time,"
    "\n  --spin X,Y,Z a steady rotation, --frozen this state";

}  // namespace lockstep
