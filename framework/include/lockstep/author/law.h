// SPDX-License-Identifier: BSD-3-Clause
// The three kinds of law: a number, a translation and a rotation as functions of time. Value and both derivatives come
// from one call, because they share sines and cosines; nothing is differenced.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <lockstep/math.h>

namespace lockstep {

/// Value of a scalar law and its first and second time derivatives.
struct LawValue {
  double y = 0,  ///< value
      yd = 0,    ///< first derivative, unit of y per s
      ydd = 0;   ///< second derivative, unit of y per s^2
};

/// A scalar law y(t), in the unit of what it drives: m, rad, N, ...
class LOCKSTEP_API MotionLaw {
 public:
  virtual ~MotionLaw();
  /// Value and derivatives at time t, s. At a breakpoint, those that hold afterwards.
  virtual LawValue at(double t) const = 0;
  /// Appends the times in (t0, t1), s, at which y, yd or ydd jumps, and at which a motion or a pulse begins and ends;
  /// integrators end a step there. Default: none.
  virtual void breakpoints(double /*t0*/, double /*t1*/, std::vector<double>& /*out*/) const {}
  /// Whether y is known to have one value at all times. Default: false.
  virtual bool is_constant() const { return false; }
};

/// Value of a law of a translation, in the axes of the frame in which it is imposed.
struct TranslationValue {
  Vec3 x = Vec3::Zero(),  ///< translation, m
      v = Vec3::Zero(),   ///< velocity, m/s
      a = Vec3::Zero();   ///< acceleration, m/s^2
};

/// A law of a translation x(t), m, in the axes of the frame in which it is imposed.
class LOCKSTEP_API TranslationLaw {
 public:
  virtual ~TranslationLaw();
  /// Translation, velocity and acceleration at time t, s. At a breakpoint, those that hold afterwards.
  virtual TranslationValue at(double t) const = 0;
  /// Appends the times in (t0, t1), s, at which x, v or a jumps, or a motion begins or ends. Default: none.
  virtual void breakpoints(double /*t0*/, double /*t1*/, std::vector<double>& /*out*/) const {}
  /// Whether its component along this unit vector is known to be constant at all times: a mechanism that moves in the
  /// plane with this normal stays there. Default: false, which keeps the mechanism in space.
  virtual bool stays_in_plane(const Vec3& /*normal*/) const { return false; }
};

/// Value of a law of a rotation. Angular velocity and acceleration are in the axes of the moved frame, so that q stays
/// a unit quaternion: (1.6), (1.9), (1.13).
struct RotationValue {
  Quat q;                 ///< moved frame's axes -> axes of the frame in which it is imposed, unit
  Vec3 w = Vec3::Zero(),  ///< angular velocity, rad/s
      a = Vec3::Zero();   ///< angular acceleration, rad/s^2
};

/// A law of a rotation q(t) of a frame against the frame in which it is imposed.
class LOCKSTEP_API RotationLaw {
 public:
  virtual ~RotationLaw();
  /// Quaternion, angular velocity and acceleration at time t, s. At a breakpoint, those that hold afterwards.
  virtual RotationValue at(double t) const = 0;
  /// Appends the times in (t0, t1), s, at which q, w or a jumps, or a motion begins or ends. Default: none.
  virtual void breakpoints(double /*t0*/, double /*t1*/, std::vector<double>& /*out*/) const {}
  /// Whether it is known to rotate about this unit vector alone at all times, as in a mechanism that moves in a plane.
  /// Default: false, which keeps the mechanism in space.
  virtual bool turns_about(const Vec3& /*axis*/) const { return false; }
};

/// A shared law L: MotionLaw, TranslationLaw or RotationLaw. Laws are immutable, so copies may be used everywhere.
template <class L>
using LawPtr = std::shared_ptr<const L>;

/// The type of a law and its origin, for messages. Kept with the pointer, not in the law.
struct LawLabel {
  std::string type;    ///< name of its type, "bump"
  std::string origin;  ///< "built in", or a plugin's name
};

/// The same law with a label, which every copy of the pointer has; at() costs no more than before.
LOCKSTEP_API LawPtr<MotionLaw> labelled(const LawPtr<MotionLaw>&, LawLabel);
/// The same for a law of a translation.
LOCKSTEP_API LawPtr<TranslationLaw> labelled(const LawPtr<TranslationLaw>&, LawLabel);
/// The same for a law of a rotation.
LOCKSTEP_API LawPtr<RotationLaw> labelled(const LawPtr<RotationLaw>&, LawLabel);

/// The label given last, valid while the pointer is; nullptr for a law without one (made in C++).
LOCKSTEP_API const LawLabel* label_of(const LawPtr<MotionLaw>&);
/// The same for a law of a translation.
LOCKSTEP_API const LawLabel* label_of(const LawPtr<TranslationLaw>&);
/// The same for a law of a rotation.
LOCKSTEP_API const LawLabel* label_of(const LawPtr<RotationLaw>&);

// NamedNumbers: what formulas know by name besides their variables.

/// A number with a name, a vector of three, or a table.
struct NamedNumbers {
  std::string name;              ///< "crank"
  std::vector<double> values{};  ///< one or three, SI; none of a table
  std::string unit{};            ///< "m"; "" without dimension, or in SI without a unit
  LawPtr<MotionLaw> table{};     ///< a function of any argument, both in SI
};

}  // namespace lockstep
