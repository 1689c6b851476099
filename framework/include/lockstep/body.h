// SPDX-License-Identifier: BSD-3-Clause
// Bodies, their inertia, and markers on them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <lockstep/author/law.h>
#include <lockstep/math.h>

namespace lockstep {

// Mass, centre of mass and inertia of a body, and the shapes that give them.

/// Mass properties in the body's frame. J is the full matrix about the centre of mass, with products as matrix entries:
/// J_xy = -integral of x y dm.
struct MassProperties {
  double mass = 0;             ///< mass, kg
  Vec3 center = Vec3::Zero();  ///< centre of mass in the body's frame, m
  Mat3 J = Mat3::Zero();       ///< inertia about the centre of mass, body axes, kg m^2
};

/// Throws ModelError naming `owner`: mass not above 0, numbers not finite, J not symmetric (to 1e-10 relative), not
/// positive definite, or violating the triangle inequality of principal moments (equality passes, to 1e-10 relative).
LOCKSTEP_API void check_mass(const MassProperties&, const std::string& owner);

/// Mass properties of common shapes, and of bodies made of them. Lengths in m, masses in kg, inertias in kg m^2.
namespace shapes {
/// Mass properties with the centre of mass `center` from an inertia about another point `origin`, in axes rotated by
/// `axes` (all in the body's frame).
LOCKSTEP_API MassProperties about(double mass, const Vec3& center, const Mat3& J_origin, const Vec3& origin,
                                  const Quat& axes = {});

/// The same mass in another frame, in which the body's own frame has the pose `pose`.
LOCKSTEP_API MassProperties moved(const MassProperties&, const Pose& pose);

/// Several parts rigidly joined: sum of masses, common centre, Steiner's terms. Throws ModelError for no part, or a
/// mass that is not above 0.
LOCKSTEP_API MassProperties compound(std::span<const MassProperties> parts);
}  // namespace shapes

/// Mass properties in a frame at the centre of mass, and the pose of that frame in the world at the start.
struct Shape {
  MassProperties mass;  ///< in the shape's frame
  Pose home;            ///< pose of the shape's frame in the world at the start
};

namespace shapes {
/// Rod from `from` to `to` (world, m): frame in the middle, x axis along the rod, z axis as near to the world's z as
/// possible (to world y for a rod along z). A solid cylinder of `radius` m, -1: length/50. Throws ModelError for a
/// mass, length or radius that is not above 0.
LOCKSTEP_API Shape rod(double mass, const Vec3& from, const Vec3& to, double radius = -1);
/// Rod without thickness, with the axial inertia given, kg m^2. Throws ModelError unless that is above 0, as a body
/// that rotates needs it, and as rod() does.
LOCKSTEP_API Shape slender_rod(double mass, const Vec3& from, const Vec3& to, double axial_inertia);
/// Solid box with sides `size` along x, y, z. Throws ModelError for a mass or side that is not above 0.
LOCKSTEP_API MassProperties box(double mass, const Vec3& size);
/// Solid cylinder along z. Throws ModelError for a mass, radius or length that is not above 0.
LOCKSTEP_API MassProperties cylinder(double mass, double radius, double length);
/// Solid sphere. Throws ModelError for a mass or radius that is not above 0.
LOCKSTEP_API MassProperties sphere(double mass, double radius);
}  // namespace shapes
LOCKSTEP_API double box_volume(const Vec3& size);                   ///< of a box with sides `size` in m, m^3
LOCKSTEP_API double cylinder_volume(double radius, double length);  ///< of a solid cylinder, m^3
LOCKSTEP_API double sphere_volume(double radius);                   ///< of a solid sphere, m^3

// Body: the description of a rigid body. Its motion is that of its slot, in the State.

/// The degrees of freedom of a free body.
enum class Freedoms {
  spatial,  ///< translates and rotates: 6 velocities
  particle  ///< translates only: 3 velocities
};

/// Slot of everything that does not move: it has no mass and no unknowns.
inline constexpr int kGround = -1;

/// A rigid body, a particle, or a fixed body; its motion is in the State.
struct Body {
  std::string name;                       ///< unique among the names of the system
  MassProperties mass;                    ///< mass, centre of mass, inertia, in the body's frame; unused if fixed
  Pose home;                              ///< pose of the body's frame in the world at the start
  Twist start;                            ///< at the start: v of the frame's origin, world, m/s; w in body axes, rad/s
  Freedoms freedoms = Freedoms::spatial;  ///< whether it rotates
  bool fixed = false;                     ///< never moves; its slot is kGround

  int slot = kGround;  ///< number of its slot, kGround when it does not move; set by System::setup
  Pose in_slot;        ///< pose of the body's frame in its slot (origin: centre of mass); set by System::setup
};

// Plane: of a planar mechanism. Its bodies have three velocities: along i, along j, and about n.

/// The plane of a planar mechanism, by its normal n. (i, j, n) is right-handed.
struct Plane {
  int n = -1;  ///< axis of the world along the normal: 0 x, 1 y, 2 z; -1: motion in space

  explicit operator bool() const { return n >= 0; }  ///< whether the mechanism is planar
  int i() const { return (n + 1) % 3; }              ///< first axis in the plane
  int j() const { return (n + 2) % 3; }              ///< second axis in the plane
  /// Index among a slot's six velocities of its planar velocity k, 0 <= k < 3.
  int velocity(int k) const { return k == 0 ? i() : k == 1 ? j() : 3 + n; }
  friend bool operator==(const Plane&, const Plane&) = default;  ///< the same normal
};

// Slot: a rigid group: one body, or several that are welded together. Its origin is their centre of mass.

/// A rigid group: bodies that move as one. Origin: the common centre of mass; axes: those of the first body, in a
/// planar mechanism the world's at the start.
struct Slot {
  double mass = 0;                        ///< sum of the masses, kg
  Mat3 J = Mat3::Zero();                  ///< inertia about the origin, slot axes, kg m^2
  Freedoms freedoms = Freedoms::spatial;  ///< particle only when it is a single particle
  std::vector<Body*> bodies;              ///< at least one; the first names the slot in messages
  Pose home;                              ///< pose in the world at the start
};

// BodyMass: the mass matrix of one slot in its unknowns: v (world) and w (slot axes) of a body, v of a particle; in a
// plane, the two or three of them in it.

/// The mass matrix of one slot: of a body, a particle, or either in a plane.
class LOCKSTEP_API BodyMass {
 public:
  BodyMass() = default;
  /// Mass m, kg, and inertia J about the centre of mass, slot axes, kg m^2; J is ignored for a particle.
  BodyMass(double m, const Mat3& J, bool particle, Plane plane = {});
  /// The mass of a slot in space or in a plane.
  BodyMass(const Slot& slot, Plane plane) : BodyMass(slot.mass, slot.J, slot.freedoms == Freedoms::particle, plane) {}

  double m() const { return m_; }       ///< mass, kg
  const Mat3& J() const { return J_; }  ///< inertia about the centre of mass, slot axes, kg m^2; zero for a particle
  /// Inverse of J, 1/(kg m^2); zero for a particle; in a plane only the entry about the normal.
  const Mat3& inverse_J() const { return inverse_J_; }
  /// Number of unknown velocities: 6, 3 for a particle; in a plane 3 and 2.
  int width() const { return plane_ ? (particle_ ? 2 : 3) : (particle_ ? 3 : 6); }

  /// Writes M and its inverse as full blocks of width() x width().
  void write_blocks(double* M, double* inverse) const;
  /// The same packed: m, Jxx, Jxy, Jxz, Jyy, Jyz, Jzz; in a plane m and J about its normal.
  void write_packed(double* M, double* inverse) const;
  /// y += M x in space; x and y are six numbers each, translation first.
  template <class X, class Y>
  void add_times(const X& x, Y&& y) const {
    y.template head<3>() += m_ * x.template head<3>();
    y.template tail<3>() += J_ * x.template tail<3>();
  }

 private:
  double m_ = 0;
  Mat3 J_ = Mat3::Zero(), inverse_J_ = Mat3::Zero();
  bool particle_ = false;
  Plane plane_;
};

/// Which of a slot's six velocities its unknowns are: the first BodyMass::width() entries count.
inline std::array<int, 6> unknown_velocities(Plane plane) {
  if (plane) return {plane.velocity(0), plane.velocity(1), plane.velocity(2)};
  return {0, 1, 2, 3, 4, 5};
}

// Marker: a frame on a body, at rest there or moved by laws.

/// A frame on a body, at rest there or moved by laws.
struct Marker {
  std::string name;      ///< unique among the names of the system
  Body* body = nullptr;  ///< the body that carries it
  Pose local;            ///< home pose in the body's frame
  LawPtr<TranslationLaw>
      translation_law{};  ///< translation from `local`, m, along the axes of `local`; absent: it does not slide
  LawPtr<RotationLaw> rotation_law{};  ///< rotation against `local`; absent: it does not rotate
};

// What is wrong with a law at some time; for messages, after an error.

/// What is wrong with a law at time t, s: "the law of drive rz ('bump' of plugin bump) gives nan, 0, 0" or "... threw:
/// its words", where `what` is "the law of drive rz"; "" when the law is finite there or absent.
LOCKSTEP_API std::string law_fault(const std::string& what, const LawPtr<MotionLaw>&, double t);
/// The same for a law of a translation.
LOCKSTEP_API std::string law_fault(const std::string& what, const LawPtr<TranslationLaw>&, double t);
/// The same for a law of a rotation.
LOCKSTEP_API std::string law_fault(const std::string& what, const LawPtr<RotationLaw>&, double t);

/// The same for the laws that move a marker: "the translation law of marker 'tool' ...".
LOCKSTEP_API std::string marker_fault(const Marker&, double t);

}  // namespace lockstep
