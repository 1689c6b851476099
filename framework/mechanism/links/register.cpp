// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/links/register.h"

#include <lockstep/author/params.h>
#include <lockstep/author/registry.h>
#include <lockstep/couplings.h>
#include <lockstep/joints.h>
#include "framework/mechanism/links/formula_joint.h"

namespace lockstep {

namespace {

using Links = decltype(Registry::links);

template <class Joint>
void add_mask_joint(Links& shelf, const char* help) {
  shelf.add({Joint::kType, help, {}}, [](const Attachment& attachment, const Params&) {
    return std::make_unique<Joint>(attachment.name, attachment.p(), attachment.s());
  });
}

}  // namespace

void register_links(Registry& registry) {
  Links& shelf = registry.links;
  add_mask_joint<Fixed>(shelf, "holds P in S; free: nothing");
  add_mask_joint<PointOnLine>(shelf, "origin of P on the z axis of S; free: sliding along z, all turns");
  add_mask_joint<PointOnPlane>(shelf, "origin of P in the xy plane of S; free: sliding along x and y, all turns");
  add_mask_joint<PlaneOnPlane>(
      shelf, "planar joint, xy planes of P and S coincide; free: sliding along x and y, turning about z");
  add_mask_joint<Revolute>(shelf, "hinge; free: turning about z of S");
  add_mask_joint<Cylindrical>(shelf, "shaft in a bore; free: turning about and sliding along z of S");
  add_mask_joint<AngularAlignment>(shelf, "axes of P parallel to those of S; free: sliding along x, y and z");
  add_mask_joint<Oldham>(shelf, "parallel shafts along z turn together; free: sliding along x and y of S");
  add_mask_joint<Prismatic>(shelf, "slider; free: sliding along z of S");
  add_mask_joint<Rzeppa>(
      shelf, "constant-velocity joint, shafts along z meet in one point; free: swinging about axes normal to z");
  add_mask_joint<Homokinetic>(
      shelf,
      "shafts along z turn at equal rates wherever they are; free: all translations, swinging about axes normal to z");
  add_mask_joint<Spherical>(shelf, "ball joint, origins coincide; free: all turns");
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
