// The three kinds of law: a number, a translation and a rotation as functions of time. Value and both derivatives come
// in one call, because sine and cosine are shared; nothing is ever differenced.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <lockstep/export.h>
#include <lockstep/math.h>

namespace lockstep {

/// y(t) and its first and second time derivatives.
struct LawValue {
  double y = 0, yd = 0, ydd = 0;
};

/// A scalar law y(t): metres, radians, newtons, whatever its user takes it for.
class LOCKSTEP_API MotionLaw {
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

/// A law of a translation: position, velocity and acceleration at a time, m.
class LOCKSTEP_API TranslationLaw {
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

/// A law of a rotation: unit quaternion, angular velocity and acceleration at a time.
class LOCKSTEP_API RotationLaw {
 public:
  virtual ~RotationLaw();
  virtual RotationValue at(double t) const = 0;
  virtual void breakpoints(double t0, double t1, std::vector<double>& out) const;
};

template <class L>
using LawPtr = std::shared_ptr<const L>;

/// What a law's class is called and who brought it: for messages. Belongs to whoever names the law, not to the law.
struct LawLabel {
  std::string type;    ///< "bump"
  std::string origin;  ///< "built in", or a plugin's name
};

/// The same law under a label, which goes with every copy of the pointer; at() costs no more than before.
LOCKSTEP_API LawPtr<MotionLaw> labelled(const LawPtr<MotionLaw>&, LawLabel);
LOCKSTEP_API LawPtr<TranslationLaw> labelled(const LawPtr<TranslationLaw>&, LawLabel);
LOCKSTEP_API LawPtr<RotationLaw> labelled(const LawPtr<RotationLaw>&, LawLabel);

/// The label given last; nullptr for a law that nobody labelled (one made in C++).
LOCKSTEP_API const LawLabel* label_of(const LawPtr<MotionLaw>&);
LOCKSTEP_API const LawLabel* label_of(const LawPtr<TranslationLaw>&);
LOCKSTEP_API const LawLabel* label_of(const LawPtr<RotationLaw>&);

}  // namespace lockstep
