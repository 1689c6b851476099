// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/law_checks.h>

#include <cmath>

#include <lockstep/function_laws.h>

namespace lockstep {

void reject(const char* law, const char* key, const std::string& problem) {
  throw ParameterError({.kind = "law", .name = law}, key, problem);
}

void require_finite(const char* law, const char* key, double value) {
  if (!std::isfinite(value)) reject(law, key, "is " + text::number(value) + "; must be a finite number");
}

void require_positive(const char* law, const char* key, double value) {
  if (!(std::isfinite(value) && value > 0)) reject(law, key, "is " + text::number(value) + "; must be above 0");
}

Vec3 require_direction(const char* law, const char* key, const Vec3& axis) {
  const double most = axis.cwiseAbs().maxCoeff();
  if (!axis.allFinite()) reject(law, key, "has a number that is not finite; give a direction");
  if (most == 0) reject(law, key, "is [0, 0, 0], which has no direction; give one that is not zero");
  return (axis / most).normalized();
}

Quat require_orientation(const char* law, const char* key, const Quat& q) {
  const Vec4 c = q.coefficients();
  const double most = c.cwiseAbs().maxCoeff();
  if (!c.allFinite()) reject(law, key, "has a number that is not finite; give a quaternion");
  if (most == 0) reject(law, key, "is [0, 0, 0, 0], which is not an orientation; [1, 0, 0, 0] is the identity");
  return normalized(Quat::from(Vec4(c / most)));
}

RotationValue rotation_value(const QuatT<Time>& r) {
  const QuatT<Time> on_sphere = normalized(r);
  const auto part = [&](double Time::*k) {
    return Quat{on_sphere.w.*k, on_sphere.x.*k, on_sphere.y.*k, on_sphere.z.*k};
  };
  const Quat q = part(&Time::v), w = conjugate(q) * part(&Time::d), a = conjugate(q) * part(&Time::h);
  return {q, {2 * w.x, 2 * w.y, 2 * w.z}, {2 * a.x, 2 * a.y, 2 * a.z}};
}

}  // namespace lockstep
