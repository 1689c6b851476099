// SPDX-License-Identifier: BSD-3-Clause
// Checks of the parameters of laws.
#pragma once

#include <cmath>
#include <memory>
#include <string>

#include <lockstep/author/law.h>
#include <lockstep/error.h>
#include <lockstep/math.h>
#include <lockstep/text.h>

namespace lockstep {

// Checks of a law's parameters. The same check serves the C++ constructor (ParameterError) and the maker, for which the
// registry adds the place of the key (SceneError).

/// Throws ParameterError for the key `key` of the law type `law`; `problem` follows the key: "is -1; must be above 0".
[[noreturn]] inline void reject(const char* law, const char* key, const std::string& problem) {
  throw ParameterError({.kind = "law", .name = law}, key, problem);
}
/// Calls reject() unless `ok`.
inline void require(bool ok, const char* law, const char* key, const std::string& problem) {
  if (!ok) reject(law, key, problem);
}
/// Calls reject() unless `value` is finite.
inline void require_finite(const char* law, const char* key, double value) {
  if (!std::isfinite(value)) reject(law, key, "is " + text::number(value) + "; must be a finite number");
}
/// Calls reject() unless `value` is finite and above 0.
inline void require_positive(const char* law, const char* key, double value) {
  if (!(std::isfinite(value) && value > 0)) reject(law, key, "is " + text::number(value) + "; must be above 0");
}
/// Calls reject() when there is no law.
template <class L>
inline void require_law(const char* law, const char* key, const std::shared_ptr<L>& inner) {
  if (!inner) reject(law, key, "is null; give a law");
}
/// `axis` scaled to length 1. Calls reject() when it is zero or not finite.
inline Vec3 require_direction(const char* law, const char* key, const Vec3& axis) {
  const double most = axis.cwiseAbs().maxCoeff();
  if (!axis.allFinite()) reject(law, key, "holds a number that is not finite; give a direction");
  if (most == 0) reject(law, key, "is [0, 0, 0], which is no direction; give one that is not zero");
  return (axis / most).normalized();
}
/// `q` scaled to length 1. Calls reject() when it is zero or not finite.
inline Quat require_orientation(const char* law, const char* key, const Quat& q) {
  const Vec4 c = q.coefficients();
  const double most = c.cwiseAbs().maxCoeff();
  if (!c.allFinite()) reject(law, key, "holds a number that is not finite; give a quaternion");
  if (most == 0) reject(law, key, "is [0, 0, 0, 0], which is no orientation; [1, 0, 0, 0] is the unturned one");
  return normalized(Quat::from(Vec4(c / most)));
}

}  // namespace lockstep
