// Inputs of a scene by name: the laws of drives and the magnitudes of forces, opened for `lockstep linearize`.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <lockstep/linearization.h>
#include <lockstep/scene.h>

namespace lockstep {

/// A mechanism with laws to which inputs can be added.
struct MechanismWithInputs {
  std::unique_ptr<Mechanism> mechanism;
  std::vector<LinearInput> inputs;
};

/// Builds the scene with an InputLaw around the law of each named thing: a link with a drive ("A"; with several "A.rz"),
/// or a force that has a magnitude ("spring": pull; "motor"; "push": along its direction). Throws UsageError for a name
/// that is none of these, with the closest, and what build_mechanism() throws.
MechanismWithInputs build_with_inputs(Scene, Registry, const std::vector<std::string>& names);

}  // namespace lockstep
