#include "framework/links/register.h"

#include "framework/links/functions.h"
#include "framework/links/joints.h"
#include "framework/links/stop.h"
#include "framework/plugin/registry.h"

namespace lockstep {

void register_links(Registry& registry) {
  auto& shelf = registry.links;
  shelf.add<Fixed>();
  shelf.add<PointOnLine>();
  shelf.add<PointOnPlane>();
  shelf.add<PlaneOnPlane>();
  shelf.add<Revolute>();
  shelf.add<Cylindrical>();
  shelf.add<AngularAlignment>();
  shelf.add<Oldham>();
  shelf.add<Prismatic>();
  shelf.add<Rzeppa>();
  shelf.add<Homokinetic>();
  shelf.add<Spherical>();
  shelf.add<Distance>();
  shelf.add<Stop>();
  shelf.add<GenericLock>();
}

}  // namespace lockstep
