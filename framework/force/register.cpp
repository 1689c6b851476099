#include "framework/force/register.h"

#include "framework/force/applied_force.h"
#include "framework/force/applied_torque.h"
#include "framework/force/bushing.h"
#include "framework/force/force_motor.h"
#include "framework/force/joint_friction.h"
#include "framework/force/spring_damper.h"
#include "framework/force/torque_motor.h"
#include "framework/force/torsion_spring_damper.h"
#include "framework/plugin/registry.h"

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
