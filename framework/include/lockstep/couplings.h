// SPDX-License-Identifier: BSD-3-Clause
// Gears, belts, racks, cams and curves.
#pragma once

#include <memory>
#include <string>

#include <lockstep/author/function_links.h>
#include <lockstep/author/law.h>

namespace lockstep {

struct Attachment;
class Params;
struct TypeInfo;

// Joints 'cam_roller' and 'cam_flat': a disc cam about z of S, its profile a law r(psi), and a follower on it.

/// A roller with the centre P on a disc cam about z of S. Free: all but the distance of P from the profile,
/// measured in the xy plane of S. It holds both ways, as in a groove; after set_unilateral() the roller may leave the
/// cam.
class LOCKSTEP_API CamRoller final : public FunctionLock {
 public:
  /// `radius`: r(psi), m, used from 0 to 2 pi; `roller`: its radius, m, zero for a knife edge. Throws ModelError: no
  /// law, a roller that is negative or infinite; and at setup as CamProfile::check.
  CamRoller(std::string name, Marker& p, Marker& s, LawPtr<MotionLaw> radius, double roller);
  std::string_view type() const override { return "cam_roller"; }
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

/// A flat face on a convex disc cam about z of S. The face passes through P, normal to y of P, which points away from
/// the cam. Free: all but the distance of the face from the cam; other joints keep z of P parallel to z of S.
class LOCKSTEP_API CamFlat final : public FunctionLock {
 public:
  /// `radius`: r(psi), m, used from 0 to 2 pi. Throws ModelError: no law; and at setup as CamProfile::check.
  CamFlat(std::string name, Marker& p, Marker& s, LawPtr<MotionLaw> radius);
  std::string_view type() const override { return "cam_flat"; }
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

// Joints 'point_on_curve' and 'path_follower': P stays on a space curve c(s), fixed to S.

/// The origin of P stays on a space curve fixed to S. Free: motion along the curve, all rotations. A closed curve is a
/// law that repeats.
class LOCKSTEP_API PointOnCurve final : public FunctionLock, public Observable {
 public:
  /// `path`: c(s) in S axes, m, over any parameter s with dc/ds not zero; `near`: an s near which P begins. Throws
  /// ModelError: no path; and at setup as CurvePoint::initialise.
  PointOnCurve(std::string name, Marker& p, Marker& s, LawPtr<TranslationLaw> path, double near = 0);
  std::string_view type() const override { return "point_on_curve"; }
  const Observable* observable() const override { return this; }
  std::vector<Quantity> quantities() const override;  ///< "s", in its own unit, and "rate", ds/dt
  double quantity(int k, const Inputs&) const override;
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

/// P follows a path fixed to S: its origin stays on a curve c(s), its axes are those of S rotated by q(s). Free: motion
/// along the curve.
class LOCKSTEP_API PathFollower final : public FunctionLock, public Observable {
 public:
  /// The path, the rotation along it, and the start of P on it.
  struct Options {
    LawPtr<TranslationLaw> path;  ///< c(s) in S axes, m, over any parameter s with dc/ds not zero
    LawPtr<RotationLaw> turn;     ///< q(s), axes of P -> axes of S
    double near = 0;              ///< an s near which P begins
  };
  /// Throws ModelError: no path or no rotation; and at setup as CurvePoint::initialise.
  PathFollower(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return "path_follower"; }
  const Observable* observable() const override { return this; }
  std::vector<Quantity> quantities() const override;  ///< "s", in its own unit, and "rate", ds/dt
  double quantity(int k, const Inputs&) const override;
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

// Joints 'gear', 'belt' and 'differential': rotations of two or three pairs, each about its z, measured on a common
// carrier. The carrier may move: a planet carrier. Bearings are separate joints; the carrier's share of the tooth force
// is in the reactions of the coupling, not in those of the bearings.

/// Two gears: theta1 + ratio theta2 (external, bevel) or theta1 - ratio theta2 (internal) keeps its value at the start.
class LOCKSTEP_API Gear final : public FunctionCoupling {
 public:
  /// How the gears meet.
  enum class Mesh {
    external,  ///< they rotate in opposite senses
    internal,  ///< they rotate in the same sense
    bevel      ///< as external; both z axes point away from the apex, or both towards it
  };
  /// `ratio`: revolutions of gear 1 per revolution of gear 2, that is teeth of 2 over teeth of 1. Throws
  /// ParameterError: a ratio that is not above zero.
  Gear(const CoupledPairs& pairs, double ratio, Mesh mesh = Mesh::external);
  std::string_view type() const override { return "gear"; }
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

/// Two pulleys with a belt that neither slips nor stretches: radius1 theta1 - radius2 theta2 keeps its value at the
/// start; of a crossed belt, radius1 theta1 + radius2 theta2.
class LOCKSTEP_API Belt final : public FunctionCoupling {
 public:
  /// Radii of the pulleys, m, and whether the belt is crossed.
  struct Options {
    double radius1,        ///< of pulley 1, m, above zero
        radius2;           ///< of pulley 2, m, above zero
    bool crossed = false;  ///< whether the pulleys rotate in opposite senses
  };
  /// Throws ParameterError: a radius that is not above zero.
  Belt(const CoupledPairs& pairs, Options options);
  std::string_view type() const override { return "belt"; }
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

/// Three rotations on one carrier: theta1 + ratio theta2 - (1 + ratio) theta3 keeps its value at the start. Ratio 1 is
/// a bevel differential: both wheels and the cage. Teeth of the ring over teeth of the sun is a planetary gear: sun,
/// ring and arm.
class LOCKSTEP_API Differential final : public FunctionCoupling {
 public:
  /// Throws ParameterError: a ratio that is not above zero.
  explicit Differential(const CoupledPairs& pairs, double ratio = 1);
  std::string_view type() const override { return "differential"; }
  static TypeInfo info();                                               ///< its keys in scenes
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);  ///< its maker for the registry
};

// Joint 'rack_and_pinion': a pinion that rolls along a rack, or the same between two joints.

/// A pinion that rolls along a rack: its centre P moves along x of S, which is fixed to the rack and is on the path
/// of the centre. Free: rolling.
class LOCKSTEP_API RollingRack final : public FunctionLock {
 public:
  /// `radius`: of the pitch circle, m; above zero for a rack on the side of -y, below zero for one on the side of +y.
  /// Throws ParameterError: a radius that is zero or not finite.
  RollingRack(std::string name, Marker& p, Marker& s, double radius);
  std::string_view type() const override { return "rack_and_pinion"; }
};

/// A pinion and a rack whose joints are separate joints on a common carrier, the ground or a moving one. They mesh at
/// the start. The carrier's share of the tooth force is in the reactions of this joint, not in those of the bearings.
class LOCKSTEP_API RackAndPinion final : public FunctionCoupling {
 public:
  /// `radius`: slide along z per radian of the pinion, m; negative reverses it. Throws ParameterError: a radius that is
  /// zero or not finite.
  RackAndPinion(const CoupledPairs& pairs, double radius);
  std::string_view type() const override { return "rack_and_pinion"; }
  static TypeInfo info();  ///< its keys in scenes
  /// Its maker for the registry: with one pair a RollingRack, with two a RackAndPinion.
  static std::unique_ptr<Lock> make(const Attachment&, const Params&);
};

}  // namespace lockstep
