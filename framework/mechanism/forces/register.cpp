// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/registry/builtins.h"

#include <lockstep/author/registry.h>
#include <lockstep/forces.h>
#include "framework/mechanism/forces/formula_force.h"

namespace lockstep {

void register_forces(Registry& registry) {
  auto& shelf = registry.forces;
  shelf.add<AppliedForce>();
  shelf.add<AppliedTorque>();
  shelf.add<SpringDamper>();
  shelf.add<TorsionSpringDamper>();
  shelf.add<ForceMotor>();
  shelf.add<TorqueMotor>();
  shelf.add<Bushing>();
  shelf.add<JointFriction>();
  shelf.add<CoordinateForce>();
}

}  // namespace lockstep
