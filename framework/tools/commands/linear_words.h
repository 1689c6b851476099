// SPDX-License-Identifier: BSD-3-Clause
// Options and state of the commands modes and linearize, and the inputs of linearize by name: drives, laws, and forces.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <lockstep/linearization.h>
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

/// Calls an analysis, and adds the next move in the program to its errors.
template <class Analysis>
auto with_words_of_program(Analysis&& analysis) {
  try {
    return analysis();
  } catch (const ModelError& error) {
    const std::string words = error.what();
    if (words.find("neither an equilibrium") == std::string::npos) throw;
    throw ModelError(
        words.substr(0, words.find("; use an equilibrium")) +
        "\n  hint: --equilibrium takes the static equilibrium (lockstep statics prints it), --at T another time,"
        "\n  --spin X,Y,Z a steady rotation, --frozen this state");
  }
}

/// A mechanism with laws to which inputs can be added.
struct MechanismWithInputs {
  std::unique_ptr<Mechanism> mechanism;
  std::vector<LinearInput> inputs;
};

/// Builds the scene with an InputLaw around the law of each named thing:
///   - a joint with a drive: "A", with several "A.rz";
///   - a force that has a magnitude: "spring": pull; "motor"; "push": along its direction; "push.x": a component;
///   - a law of time of a joint, a force or a marker: "rope.length", "A.move.x", "table.translation.z", "B.turn.x";
///   - a force of any other type without such a law: "pad.x" ... "pad.rz": a force along an axis of S, or a torque about
///     it, in addition.
/// Throws UsageError for a name that is none of these, with the closest or the next move, and what build_mechanism()
/// throws.
MechanismWithInputs build_with_inputs(Scene, Registry, const std::vector<std::string>& names);

}  // namespace lockstep
