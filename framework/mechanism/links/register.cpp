// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/registry/builtins.h"

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
  add_mask_joint<Fixed>(shelf, "weld, P coincides with S; degrees of freedom left: none");
  add_mask_joint<PointOnLine>(shelf, "P on axis z of S; degrees of freedom left: translation along z, all rotations");
  add_mask_joint<PointOnPlane>(shelf,
                               "P in plane xy of S; degrees of freedom left: translation along x and y, all rotations");
  add_mask_joint<PlaneOnPlane>(
      shelf, "planar joint, xy planes coincide; degrees of freedom left: translation along x and y, rotation about z");
  add_mask_joint<Revolute>(shelf, "hinge; degrees of freedom left: rotation about z of S");
  add_mask_joint<Cylindrical>(shelf, "shaft in a bore; degrees of freedom left: rotation about z, translation along z");
  add_mask_joint<AngularAlignment>(shelf, "axes parallel; degrees of freedom left: translation along x, y and z of S");
  add_mask_joint<Oldham>(shelf, "parallel shafts rotate together; degrees of freedom left: translation along x and y");
  add_mask_joint<Prismatic>(shelf, "slider; degrees of freedom left: translation along z of S");
  add_mask_joint<Rzeppa>(
      shelf, "constant-velocity joint, shafts along z meet; degrees of freedom left: two rotations normal to z");
  add_mask_joint<Homokinetic>(
      shelf, "shafts along z rotate at equal rates; degrees of freedom left: translations, two rotations normal to z");
  add_mask_joint<Spherical>(shelf, "ball joint, origins coincide; degrees of freedom left: all rotations");
  add_types<Distance, Screw, Universal, RackAndPinion, Gear, Belt, Differential, CamRoller, CamFlat, PointOnCurve,
            PathFollower, Stop, GenericLock, FormulaJoint>(shelf);
}

}  // namespace lockstep
