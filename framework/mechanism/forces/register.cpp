#include "framework/mechanism/forces/register.h"

#include "framework/description/registry/registry.h"
#include "framework/mechanism/forces/applied.h"
#include "framework/mechanism/forces/bushing.h"
#include "framework/mechanism/forces/joint_friction.h"
#include "framework/mechanism/forces/motor.h"
#include "framework/mechanism/forces/spring_damper.h"
#include "framework/mechanism/forces/torsion_spring_damper.h"

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
}

}  // namespace lockstep
