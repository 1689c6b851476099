// Mass, mass centre and inertia of a body, and the shapes that bring them.
#pragma once

#include <span>
#include <string>

#include "framework/foundation/math/pose.h"
#include "framework/foundation/support/export.h"

namespace lockstep {

/// Mass properties in the body's frame. J about the mass centre, body axes, full matrix (products as matrix entries:
/// J_xy = -integral of x y dm).
struct MassProperties {
  double mass = 0;             ///< kg
  Vec3 center = Vec3::Zero();  ///< mass centre in the body's frame, m
  Mat3 J = Mat3::Zero();       ///< kg m^2
};

/// Throws ModelError naming `owner`: mass <= 0, not finite, J not symmetric, not positive definite, or against the
/// triangle rule of principal moments (equality passes, to 1e-10 relative).
LOCKSTEP_API void check(const MassProperties&, const std::string& owner);

namespace shapes {
/// Inertia given about another point `origin` and in axes turned by `axes` (both in the body's frame), as mass
/// properties.
LOCKSTEP_API MassProperties about(double mass, const Vec3& center, const Mat3& J_origin, const Vec3& origin,
                                  const Quat& axes = {});

/// The same body seen from a frame in which its own frame has the pose `pose`.
LOCKSTEP_API MassProperties moved(const MassProperties&, const Pose& pose);

/// Several rigidly joined: sum of masses, common centre, Steiner's terms.
LOCKSTEP_API MassProperties compound(std::span<const MassProperties> parts);
}  // namespace shapes

/// A shape at its mass centre, axes as said; with the pose that its makers give it in the world.
struct Shape {
  MassProperties mass;
  Pose home;
};

namespace shapes {
/// Rod from `from` to `to` (world, m): frame in the middle, x axis along the rod, z axis as near to the world's z as
/// can be (world y for a rod along z). A solid cylinder of `radius` (default: length/50).
LOCKSTEP_API Shape rod(double mass, const Vec3& from, const Vec3& to, double radius = -1);
/// Rod without thickness, with the axial inertia given, kg m^2 (must be > 0: a body that turns needs one).
LOCKSTEP_API Shape slender_rod(double mass, const Vec3& from, const Vec3& to, double axial_inertia);
LOCKSTEP_API MassProperties box(double mass, const Vec3& size);
LOCKSTEP_API MassProperties cylinder(double mass, double radius, double length);  ///< axis z
LOCKSTEP_API MassProperties sphere(double mass, double radius);
}  // namespace shapes
LOCKSTEP_API double box_volume(const Vec3& size);
LOCKSTEP_API double cylinder_volume(double radius, double length);
LOCKSTEP_API double sphere_volume(double radius);

}  // namespace lockstep
