#include "framework/mechanism/links/register.h"

#include "framework/mechanism/links/cam.h"
#include "framework/mechanism/links/curve.h"
#include "framework/mechanism/links/distance.h"
#include "framework/mechanism/links/gears.h"
#include "framework/mechanism/links/joints.h"
#include "framework/mechanism/links/rack_and_pinion.h"
#include "framework/mechanism/links/screw.h"
#include "framework/mechanism/links/stop.h"
#include "framework/mechanism/links/universal.h"
#include "framework/description/registry/registry.h"

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
  shelf.add<Screw>();
  shelf.add<Universal>();
  shelf.add<RackAndPinion>();
  shelf.add<Gear>();
  shelf.add<Belt>();
  shelf.add<Differential>();
  shelf.add<CamRoller>();
  shelf.add<CamFlat>();
  shelf.add<PointOnCurve>();
  shelf.add<PathFollower>();
  shelf.add<Stop>();
  shelf.add<GenericLock>();
}

}  // namespace lockstep
