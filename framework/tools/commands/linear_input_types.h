// SPDX-License-Identifier: BSD-3-Clause
// Types of laws and forces that hold the inputs of a linearisation, for a separate registry.
#pragma once

#include <memory>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/linearization.h>

namespace lockstep {

/// The inputs by number; made with the mechanism.
using InputLaws = std::vector<std::shared_ptr<InputLaw>>;

inline constexpr const char *kInputLaw = "linear_input",  ///< scalar law: {"number", "law"}
    *kInputTranslation = "linear_input_along",            ///< translation law: {"number", "axis", "law"}
        *kInputForce = "linear_input_force";              ///< force: {"number", "along"}

/// Adds types that put the input with a number
///   - added to a scalar law, which may be absent;
///   - added to a translation law, along one of its axes 0, 1, 2;
///   - into a force along an axis of S on p's body at P, or a torque about it (axes 3, 4, 5), and the opposite on s's body.
void add_input_types(Registry&, const std::shared_ptr<InputLaws>&);

}  // namespace lockstep
