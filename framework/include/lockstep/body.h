// Bodies, their inertia, and markers on them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <lockstep/export.h>
#include <lockstep/law.h>
#include <lockstep/math.h>

namespace lockstep {

// Mass, mass centre and inertia of a body, and the shapes that bring them.


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


// Body: a rigid body as description. It holds no motion: that is its slot's, in the State.


/// What a body can do: turn as well (6 velocities), or only move (3, a particle).
enum class Freedoms { spatial, particle };

/// Slot of everything that never moves: no columns, no mass, no unknowns.
inline constexpr int kGround = -1;

/// A rigid body, a particle, or what is fixed; its motion is in the State.
struct Body {
  std::string name;
  MassProperties mass;
  Pose home;    ///< pose of the body's frame in the world at the start
  Twist start;  ///< v of the frame's origin, world; w in body axes
  Freedoms freedoms = Freedoms::spatial;
  bool fixed = false;

  int slot = kGround;  ///< set by System::setup
  Pose in_slot;        ///< pose of the body's frame in its slot (a slot's origin is its mass centre)
};


// Plane: of a mechanism that moves in one. Three velocities a body: along i, along j, about n.


/// The plane of a planar mechanism, by its normal.
struct Plane {
  int n = -1;  ///< its normal: 0 x, 1 y, 2 z of the world; -1: motion in space

  explicit operator bool() const { return n >= 0; }
  int i() const { return (n + 1) % 3; }
  int j() const { return (n + 2) % 3; }
  /// Which of a slot's six velocities is number k.
  int velocity(int k) const { return k == 0 ? i() : k == 1 ? j() : 3 + n; }
  friend bool operator==(const Plane&, const Plane&) = default;
};


// Slot: what moves as one: a body, or several that are bolted together. Its origin is the common mass centre.


/// Bodies that move as one: mass, inertia and mass centre.
struct Slot {
  std::vector<Body*> bodies;  ///< the first gives it its name in messages
  double mass = 0;            ///< kg
  Mat3 J = Mat3::Zero();      ///< inertia about the origin, slot axes, kg m^2
  Pose home;                  ///< of the slot in the world at the start
  Freedoms freedoms = Freedoms::spatial;
};


// BodyMass: the mass matrix of one slot in its unknowns: v (world) and w (slot axes) of a body, v alone of a particle;
// in a plane the two or three velocities of it.


/// Mass and inertia of what moves as one: a body, a particle, or a body in a plane.
class LOCKSTEP_API BodyMass {
 public:
  BodyMass() = default;
  BodyMass(double m, const Mat3& J, bool particle, Plane plane = {});
  BodyMass(const Slot& slot, Plane plane) : BodyMass(slot.mass, slot.J, slot.freedoms == Freedoms::particle, plane) {}

  double m() const { return m_; }
  /// Inertia in slot axes, and its inverse: zero of a particle, which does not turn.
  const Mat3& J() const { return J_; }
  const Mat3& inverse_J() const { return inverse_J_; }
  int width() const { return plane_ ? (particle_ ? 2 : 3) : (particle_ ? 3 : 6); }

  /// M and its inverse as blocks of width x width.
  void write_blocks(double* M, double* inverse) const;
  /// The same as m, Jxx, Jxy, Jxz, Jyy, Jyz, Jzz; in a plane as m and J about its normal.
  void write_packed(double* M, double* inverse) const;
  /// y += M x, six numbers each.
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

/// Which of the six velocities of a slot its unknowns are.
inline std::array<int, 6> unknown_velocities(Plane plane) {
  if (plane) return {plane.velocity(0), plane.velocity(1), plane.velocity(2)};
  return {0, 1, 2, 3, 4, 5};
}


// Marker: a frame on a body, still or moving by two laws.


/// A frame on a body, at rest there or moved by laws.
struct Marker {
  std::string name;
  Body* body = nullptr;
  Pose local;  ///< in the body's frame
  LawPtr<TranslationLaw>
      slide{};  ///< moves the marker along its own home axes (those of `local`); absent: it does not slide
  LawPtr<RotationLaw> spin{};  ///< turns it about them; absent: it does not turn
};


// What is wrong with a law at an instant; asked once something went wrong.


/// "the law of drive rz ('bump' of plugin bump) gives nan, 0, 0" or "... threw: its words", where `what` is "the law of
/// drive rz"; "" when the law is finite at t, and for no law.
LOCKSTEP_API std::string law_fault(const std::string& what, const LawPtr<MotionLaw>&, double t);
LOCKSTEP_API std::string law_fault(const std::string& what, const LawPtr<TranslationLaw>&, double t);
LOCKSTEP_API std::string law_fault(const std::string& what, const LawPtr<RotationLaw>&, double t);

/// The same of the laws that move a marker: "the sliding law of marker 'tool' ...".
LOCKSTEP_API std::string marker_fault(const Marker&, double t);

}  // namespace lockstep
