// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/links/register.h"

#include <lockstep/author/registry.h>
#include <lockstep/couplings.h>
#include <lockstep/joints.h>
#include "framework/mechanism/links/formula_joint.h"

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
  shelf.add<FormulaJoint>();
}

}  // namespace lockstep
