// SPDX-License-Identifier: BSD-3-Clause
// The joints.
#pragma once

#include <memory>
#include <string>

#include <lockstep/author/function_links.h>
#include <lockstep/author/lock.h>

namespace lockstep {

struct Attachment;
class Params;
struct TypeInfo;

// Joint 'distance'.

/// A distance between the origins of P and S, constant or by a law. Free: all motions that keep the distance. It has no
/// direction at length zero: setup() throws ModelError if the length at t = 0 or the distance at the start is zero.
class LOCKSTEP_API Distance final : public FunctionLock {
 public:
  /// Of constant length, m, above zero.
  Distance(std::string name, Marker& p, Marker& s, double length);
  /// Of a length by a law, m, above zero. Throws ModelError: no law.
  Distance(std::string name, Marker& p, Marker& s, LawPtr<MotionLaw> length);
  /// Of the length that the distance has at the start.
  Distance(std::string name, Marker& p, Marker& s);
  std::string_view type() const override { return "distance"; }
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry

 protected:
  RowPlan plan_rows() override;
};

// The joints: each is a mask and a name. P is on body 1, S on body 2; axes are those of S. "Free" lists the motions of
// P that are left free, seen from S.

/// A joint that is only a mask. The class Self defines kType, its type in scenes.
template <class Self, Mask kMask>
class MaskJoint : public MarkerLock {
 public:
  /// Holds P at S in the coordinates of kMask. Throws ModelError: both markers are on one body.
  MaskJoint(std::string name, Marker& p, Marker& s) : MarkerLock(std::move(name), p, s, kMask) {}
  /// Self::kType.
  std::string_view type() const override { return Self::kType; }
};

/// A weld: P coincides with S in position and orientation. Free: nothing. With `move()` and `turn()` it imposes a whole
/// motion.
struct LOCKSTEP_API Fixed final : MaskJoint<Fixed, Mask::all> {
  static constexpr const char* kType = "fixed";  ///< type
  using MaskJoint::MaskJoint;
};
/// The origin of P stays on the z axis of S. Free: translation along z, all rotations.
struct LOCKSTEP_API PointOnLine final : MaskJoint<PointOnLine, Mask::x | Mask::y> {
  static constexpr const char* kType = "point_on_line";  ///< type
  using MaskJoint::MaskJoint;
};
/// The origin of P stays in the xy plane of S. Free: translation along x and y, all rotations.
struct LOCKSTEP_API PointOnPlane final : MaskJoint<PointOnPlane, Mask::z> {
  static constexpr const char* kType = "point_on_plane";  ///< type
  using MaskJoint::MaskJoint;
};
/// A planar joint: the xy planes of P and S coincide. Free: translation along x and y, rotation about z.
struct LOCKSTEP_API PlaneOnPlane final : MaskJoint<PlaneOnPlane, Mask::z | Mask::e1 | Mask::e2> {
  static constexpr const char* kType = "plane_on_plane";  ///< type
  using MaskJoint::MaskJoint;
};
/// A hinge. Free: rotation about z.
struct LOCKSTEP_API Revolute final : MaskJoint<Revolute, Mask::xyz | Mask::e1 | Mask::e2> {
  static constexpr const char* kType = "revolute";  ///< type
  using MaskJoint::MaskJoint;
};
/// A shaft in a bore. Free: rotation about z, translation along z.
struct LOCKSTEP_API Cylindrical final : MaskJoint<Cylindrical, Mask::x | Mask::y | Mask::e1 | Mask::e2> {
  static constexpr const char* kType = "cylindrical";  ///< type
  using MaskJoint::MaskJoint;
};
/// The axes of P stay parallel to those of S. Free: translation along x, y and z.
struct LOCKSTEP_API AngularAlignment final : MaskJoint<AngularAlignment, Mask::e123> {
  static constexpr const char* kType = "angular_alignment";  ///< type
  using MaskJoint::MaskJoint;
};
/// An Oldham coupling: two parallel shafts along z rotate together. Free: translation along x and y.
struct LOCKSTEP_API Oldham final : MaskJoint<Oldham, Mask::z | Mask::e123> {
  static constexpr const char* kType = "oldham";  ///< type
  using MaskJoint::MaskJoint;
};
/// A slider. Free: translation along z.
struct LOCKSTEP_API Prismatic final : MaskJoint<Prismatic, Mask::x | Mask::y | Mask::e123> {
  static constexpr const char* kType = "prismatic";  ///< type
  using MaskJoint::MaskJoint;
};
/// A constant-velocity joint: shafts along z_P and z_S meet in one point and rotate at equal rates at every bend below
/// 180 degrees (4.21). Free: rotation about all axes normal to z.
struct LOCKSTEP_API Rzeppa final : MaskJoint<Rzeppa, Mask::xyz | Mask::e3> {
  static constexpr const char* kType = "rzeppa";  ///< type
  using MaskJoint::MaskJoint;
};
/// The rotational row of a Rzeppa joint: shafts along z_P and z_S rotate at equal rates in any position. Free:
/// translation along x, y and z, rotation about all axes normal to z.
struct LOCKSTEP_API Homokinetic final : MaskJoint<Homokinetic, Mask::e3> {
  static constexpr const char* kType = "homokinetic";  ///< type
  using MaskJoint::MaskJoint;
};
/// A ball joint: the origins of P and S coincide. Free: all rotations.
struct LOCKSTEP_API Spherical final : MaskJoint<Spherical, Mask::xyz> {
  static constexpr const char* kType = "spherical";  ///< type
  using MaskJoint::MaskJoint;
};

/// The lock of any mask; in scenes the type "lock", with the mask in words: "x y z e1 e2".
class LOCKSTEP_API GenericLock final : public MarkerLock {
 public:
  using MarkerLock::MarkerLock;
  std::string_view type() const override { return "lock"; }
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

// Joint 'screw'.

/// A screw on a thread about z of S. Free: rotation about z, coupled to translation along z, without limit.
class LOCKSTEP_API Screw final : public FunctionLock, public Observable {
 public:
  /// `lead`: m per revolution, negative for a left-hand thread; `slip`: law of the axial offset from the thread through
  /// the start poses, m. Throws ParameterError: a lead that is not finite.
  Screw(std::string name, Marker& p, Marker& s, double lead, LawPtr<MotionLaw> slip = {});
  std::string_view type() const override { return "screw"; }
  const Observable* observable() const override { return this; }
  std::vector<Quantity> quantities() const override;  ///< "angle", counted, rad, and "rate", rad/s
  double quantity(int k, const Inputs&) const override;
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

// Joint 'stop': one end of the travel of one coordinate; a unilateral joint.

/// One end of a travel along x, y or z of S; a unilateral joint, by default without restitution. Free: all motions on
/// one side of the limit.
class LOCKSTEP_API SlideStop final : public FunctionLock {
 public:
  /// The end of the travel, m.
  struct Options {
    int axis = 0;      ///< of S: 0 x, 1 y, 2 z
    double limit = 0;  ///< m
    bool low = true;   ///< whether the coordinate stays above the limit; otherwise below it
  };
  /// Throws ModelError: a limit that is not finite.
  SlideStop(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return "stop"; }
};

/// One end of a rotation about z of S; a unilateral joint, by default without restitution. The angle starts within half
/// a revolution of zero, or in the revolution requested by a start or a drive, and continues past full revolutions.
/// Free: all motions on one side of the limit.
class LOCKSTEP_API TurnStop final : public FunctionLock {
 public:
  /// The end of the rotation, rad.
  struct Options {
    double limit = 0;  ///< rad
    bool low = true;   ///< whether the angle stays above the limit; otherwise below it
  };
  /// Throws ModelError: a limit that is not finite.
  TurnStop(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return "stop"; }
};

/// The type "stop" of scenes: a SlideStop or a TurnStop.
struct LOCKSTEP_API Stop {
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

// Joint 'universal'.

/// Hooke's joint: origins coincide, and x of S and y of P are the pins of its cross. Free: rotation about both pins.
class LOCKSTEP_API Universal final : public FunctionLock {
 public:
  /// Throws ModelError: both markers are on one body.
  Universal(std::string name, Marker& p, Marker& s);
  std::string_view type() const override { return "universal"; }
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

}  // namespace lockstep
