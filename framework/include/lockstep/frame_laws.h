// SPDX-License-Identifier: BSD-3-Clause
// Laws of translations and rotations.
#pragma once

#include <lockstep/author/law.h>

namespace lockstep {

namespace laws {
// Rotation laws 'constant', 'axis_rotation' and 'product'. Angular velocity w and acceleration a are in the axes of the
// moved frame.

/// A fixed orientation, q = `orientation`, of any length but zero. Throws ModelError if it is zero or not finite.
LOCKSTEP_API LawPtr<RotationLaw> constant_rotation(const Quat& orientation);
/// A rotation about a fixed axis: q = (cos(y/2), n sin(y/2)), w = n yd, a = n ydd, with the scalar law y, rad, and the
/// axis n of length 1, which has the same components in the frame and in the moved frame. `axis` of any length but
/// zero. Throws ModelError for a zero axis, numbers that are not finite, no law.
LOCKSTEP_API LawPtr<RotationLaw> axis_rotation(const Vec3& axis, LawPtr<MotionLaw> law);
/// Two rotations one after the other: q = q1 q2, q2 about the axes rotated by q1. As (4.10), with A2 = A(q2):
/// w = A2^T w1 + w2, a = A2^T a1 + a2 + (A2^T w1) x w2. Throws ModelError for a missing law.
LOCKSTEP_API LawPtr<RotationLaw> rotation_product(LawPtr<RotationLaw> first, LawPtr<RotationLaw> second);

// Translation laws 'constant', 'components' and 'along'. Axes are those of the frame in which the law is imposed.

/// A fixed translation, x = value, m. Throws ModelError unless finite.
LOCKSTEP_API LawPtr<TranslationLaw> constant_translation(const Vec3& value);
/// A scalar law, m, for each component: x = (x(t), y(t), z(t)). Throws ModelError for a missing law.
LOCKSTEP_API LawPtr<TranslationLaw> components(LawPtr<MotionLaw> x, LawPtr<MotionLaw> y, LawPtr<MotionLaw> z);
/// A translation along a line: x = origin + n s(t), m, with the scalar law s, m, and the direction n of length 1. `axis` of
/// any length but zero. Throws ModelError for a zero axis, numbers that are not finite, no law.
LOCKSTEP_API LawPtr<TranslationLaw> along(const Vec3& axis, LawPtr<MotionLaw> law, const Vec3& origin = Vec3::Zero());
}  // namespace laws

}  // namespace lockstep
