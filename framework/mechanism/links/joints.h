// The joints: each a mask and a name. P is on O1, S on O2; axes are those of S. "Free" says what P may do seen from S.
#pragma once

#include <memory>

#include "framework/mechanism/lock/marker_lock.h"
#include "framework/mechanism/params/site.h"

namespace lockstep {

/// A joint that is nothing but a mask: the class says its name, its rows and one line of help.
template <class Self, Mask kMask>
class MaskJoint : public MarkerLock {
 public:
  MaskJoint(std::string name, Marker& p, Marker& s) : MarkerLock(std::move(name), p, s, kMask) {}
  std::string_view type() const override { return Self::kType; }
  static TypeInfo info() { return {Self::kType, Self::kHelp, {}}; }
  static std::unique_ptr<Lock> make(const Site& site, const Params&) {
    return std::make_unique<Self>(site.name, site.p(), site.s());
  }
};

/// Free: nothing. Holds P in S, position and orientation (table 1: fixed). With move() and turn() it is the full
/// motion.
struct LOCKSTEP_API Fixed final : MaskJoint<Fixed, Mask::all> {
  static constexpr const char* kType = "fixed";
  static constexpr const char* kHelp = "holds P in S; free: nothing";
  using MaskJoint::MaskJoint;
};
/// Free: sliding along z of S, all turns. The origin of P stays on the z axis of S.
struct LOCKSTEP_API PointOnLine final : MaskJoint<PointOnLine, Mask::x | Mask::y> {
  static constexpr const char* kType = "point_on_line";
  static constexpr const char* kHelp = "origin of P on the z axis of S; free: sliding along z, all turns";
  using MaskJoint::MaskJoint;
};
/// Free: sliding along x and y of S, all turns. The origin of P stays in the xy plane of S.
struct LOCKSTEP_API PointOnPlane final : MaskJoint<PointOnPlane, Mask::z> {
  static constexpr const char* kType = "point_on_plane";
  static constexpr const char* kHelp = "origin of P in the xy plane of S; free: sliding along x and y, all turns";
  using MaskJoint::MaskJoint;
};
/// Free: sliding along x and y of S, turning about z of S. The xy planes of P and S coincide.
struct LOCKSTEP_API PlaneOnPlane final : MaskJoint<PlaneOnPlane, Mask::z | Mask::e1 | Mask::e2> {
  static constexpr const char* kType = "plane_on_plane";
  static constexpr const char* kHelp =
      "planar joint, xy planes of P and S coincide; free: sliding along x and y, turning about z";
  using MaskJoint::MaskJoint;
};
/// Free: turning about z of S.
struct LOCKSTEP_API Revolute final : MaskJoint<Revolute, Mask::xyz | Mask::e1 | Mask::e2> {
  static constexpr const char* kType = "revolute";
  static constexpr const char* kHelp = "hinge; free: turning about z of S";
  using MaskJoint::MaskJoint;
};
/// Free: turning about and sliding along z of S.
struct LOCKSTEP_API Cylindrical final : MaskJoint<Cylindrical, Mask::x | Mask::y | Mask::e1 | Mask::e2> {
  static constexpr const char* kType = "cylindrical";
  static constexpr const char* kHelp = "shaft in a bore; free: turning about and sliding along z of S";
  using MaskJoint::MaskJoint;
};
/// Free: sliding along x, y and z of S. No turns.
struct LOCKSTEP_API AngularAlignment final : MaskJoint<AngularAlignment, Mask::e123> {
  static constexpr const char* kType = "angular_alignment";
  static constexpr const char* kHelp = "axes of P parallel to those of S; free: sliding along x, y and z";
  using MaskJoint::MaskJoint;
};
/// Free: sliding along x and y of S. Two parallel shafts along z turn together (the paper's Oldham joint as one lock).
struct LOCKSTEP_API Oldham final : MaskJoint<Oldham, Mask::z | Mask::e123> {
  static constexpr const char* kType = "oldham";
  static constexpr const char* kHelp = "parallel shafts along z turn together; free: sliding along x and y of S";
  using MaskJoint::MaskJoint;
};
/// Free: sliding along z of S.
struct LOCKSTEP_API Prismatic final : MaskJoint<Prismatic, Mask::x | Mask::y | Mask::e123> {
  static constexpr const char* kType = "prismatic";
  static constexpr const char* kHelp = "slider; free: sliding along z of S";
  using MaskJoint::MaskJoint;
};
/// Free: swinging about every axis normal to z of S. Shafts along z_P and z_S meet in one point and turn at equal rates
/// at every bend (4.21), short of a half turn.
struct LOCKSTEP_API Rzeppa final : MaskJoint<Rzeppa, Mask::xyz | Mask::e3> {
  static constexpr const char* kType = "rzeppa";
  static constexpr const char* kHelp =
      "constant-velocity joint, shafts along z meet in one point; free: swinging about axes normal to z";
  using MaskJoint::MaskJoint;
};
/// Free: all translations, swinging about every axis normal to z of S. The orientation half of the Rzeppa joint.
struct LOCKSTEP_API Homokinetic final : MaskJoint<Homokinetic, Mask::e3> {
  static constexpr const char* kType = "homokinetic";
  static constexpr const char* kHelp =
      "shafts along z turn at equal rates wherever they are; free: all translations, swinging about axes normal to z";
  using MaskJoint::MaskJoint;
};
/// Free: all turns. The origins of P and S coincide.
struct LOCKSTEP_API Spherical final : MaskJoint<Spherical, Mask::xyz> {
  static constexpr const char* kType = "spherical";
  static constexpr const char* kHelp = "ball joint, origins coincide; free: all turns";
  using MaskJoint::MaskJoint;
};

/// The lock itself, by its mask in words: "x y z e1 e2".
class LOCKSTEP_API GenericLock final : public MarkerLock {
 public:
  using MarkerLock::MarkerLock;
  std::string_view type() const override { return "lock"; }
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

}  // namespace lockstep
