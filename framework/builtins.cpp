// The one file that knows every room's register function.
#include "framework/builtins.h"

#include "framework/force/register.h"
#include "framework/kkt/register.h"
#include "framework/links/register.h"
#include "integrators/register.h"
#include "motionlaws/register.h"

namespace lockstep {

Registry builtin_registry() {
  Registry registry;
  register_motion_laws(registry);
  register_links(registry);
  register_forces(registry);
  register_integrators(registry);
  register_solvers(registry);
  registry.laws.set_origin("built in");
  registry.translation_laws.set_origin("built in");
  registry.rotation_laws.set_origin("built in");
  registry.links.set_origin("built in");
  registry.forces.set_origin("built in");
  registry.integrators.set_origin("built in");
  registry.solvers.set_origin("built in");
  return registry;
}

}  // namespace lockstep
