// The three kinds of law: a number, a translation and a rotation as functions of time. Value and both derivatives come
// in one call, because sine and cosine are shared; nothing is ever differenced.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "framework/foundation/math/quaternion.h"
#include "framework/foundation/support/export.h"

namespace lockstep {

/// y(t) and its first and second time derivatives.
struct LawValue {
  double y = 0, yd = 0, ydd = 0;
};

/// Who brought a law's class and what it is called there: for messages. Written by the registry that makes the law.
class LawName {
 public:
  const std::string& type() const { return type_; }      ///< "bump"; "" for a law that no registry made
  const std::string& origin() const { return origin_; }  ///< "built in", or a plugin's name
  void set_name(std::string type, std::string origin) const { type_ = std::move(type), origin_ = std::move(origin); }

 private:
  mutable std::string type_, origin_;  // a law is handed out const, and this is no part of what it says
};

/// A scalar law y(t): metres, radians, newtons, whatever its user takes it for.
class LOCKSTEP_API MotionLaw : public LawName {
 public:
  virtual ~MotionLaw();
  virtual LawValue at(double t) const = 0;
  /// Appends the instants in (t0, t1) where y, yd or ydd jumps (integrators land on them). Default: none.
  virtual void breakpoints(double t0, double t1, std::vector<double>& out) const;
};

/// Translation x(t), m, with velocity and acceleration, in the axes of the frame in which it is imposed.
struct TranslationValue {
  Vec3 x = Vec3::Zero(), v = Vec3::Zero(), a = Vec3::Zero();
};

class LOCKSTEP_API TranslationLaw : public LawName {
 public:
  virtual ~TranslationLaw();
  virtual TranslationValue at(double t) const = 0;
  virtual void breakpoints(double t0, double t1, std::vector<double>& out) const;
};

/// Rotation q(t), unit; angular velocity w and acceleration a in the moved frame's own axes (so that no rate can leave
/// the unit sphere: (1.6), (1.9), (1.13)).
struct RotationValue {
  Quat q;
  Vec3 w = Vec3::Zero(), a = Vec3::Zero();
};

class LOCKSTEP_API RotationLaw : public LawName {
 public:
  virtual ~RotationLaw();
  virtual RotationValue at(double t) const = 0;
  virtual void breakpoints(double t0, double t1, std::vector<double>& out) const;
};

template <class L>
using LawPtr = std::shared_ptr<const L>;

}  // namespace lockstep
