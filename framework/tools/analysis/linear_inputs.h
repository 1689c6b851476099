// SPDX-License-Identifier: BSD-3-Clause
// The inputs of a linearisation by name: drives, laws, and forces of a scene.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/linearization.h>
#include <lockstep/scene.h>

namespace lockstep {

/// A name that is no input of a scene.
class UnknownInput final : public ModelError {
 public:
  using ModelError::ModelError;
};

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
/// Throws UnknownInput for a name that is none of these, with the closest or the next move, and what build_mechanism()
/// throws.
LOCKSTEP_API MechanismWithInputs build_with_inputs(Scene, Registry, const std::vector<std::string>& names);

}  // namespace lockstep
