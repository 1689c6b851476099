// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/registry/builtins.h"

#include <lockstep/author/registry.h>
#include <lockstep/forces.h>
#include "framework/mechanism/forces/formula_force.h"

namespace lockstep {

void register_forces(Registry& registry) {
  add_types<AppliedForce, AppliedTorque, SpringDamper, TorsionSpringDamper, ForceMotor, TorqueMotor, Bushing,
            JointFriction, CoordinateForce>(registry.forces);
}

}  // namespace lockstep
