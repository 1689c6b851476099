// Checks of a law's parameters: one check serves the C++ constructor (ParameterError) and the maker, for which the
// registry adds the key's place (SceneError).
#pragma once

#include <cmath>
#include <string>
#include <utility>

#include "framework/foundation/support/error.h"
#include "framework/foundation/support/text.h"
#include "framework/mechanism/params/params.h"

namespace lockstep {

// Each throws ParameterError; `problem` follows the key: "is -1; must be above 0".

[[noreturn]] inline void reject(const char* law, const char* key, const std::string& problem) {
  throw ParameterError({.kind = "law", .name = law}, key, problem);
}
inline void require(bool ok, const char* law, const char* key, const std::string& problem) {
  if (!ok) reject(law, key, problem);
}
inline void require_finite(const char* law, const char* key, double value) {
  if (!std::isfinite(value)) reject(law, key, "is " + number(value) + "; must be a finite number");
}
inline void require_positive(const char* law, const char* key, double value) {
  if (!(std::isfinite(value) && value > 0)) reject(law, key, "is " + number(value) + "; must be above 0");
}
template <class L>
inline void require_law(const char* law, const char* key, const std::shared_ptr<L>& inner) {
  if (!inner) reject(law, key, "is null; give a law");
}
/// `axis` at length 1.
inline Vec3 require_direction(const char* law, const char* key, const Vec3& axis) {
  const double most = axis.cwiseAbs().maxCoeff();
  if (!axis.allFinite()) reject(law, key, "holds a number that is not finite; give a direction");
  if (most == 0) reject(law, key, "is [0, 0, 0], which is no direction; give one that is not zero");
  return (axis / most).normalized();
}
/// `q` at length 1.
inline Quat require_orientation(const char* law, const char* key, const Quat& q) {
  const Vec4 c = q.coefficients();
  const double most = c.cwiseAbs().maxCoeff();
  if (!c.allFinite()) reject(law, key, "holds a number that is not finite; give a quaternion");
  if (most == 0) reject(law, key, "is [0, 0, 0, 0], which is no orientation; [1, 0, 0, 0] is the unturned one");
  return normalized(Quat::from(Vec4(c / most)));
}

}  // namespace lockstep
