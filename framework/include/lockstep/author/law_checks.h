// SPDX-License-Identifier: BSD-3-Clause
// Checks of the parameters of laws.
#pragma once

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
[[noreturn]] LOCKSTEP_API void reject(const char* law, const char* key, const std::string& problem);
/// Calls reject() unless `ok`.
inline void require(bool ok, const char* law, const char* key, const std::string& problem) {
  if (!ok) reject(law, key, problem);
}
/// Calls reject() unless `value` is finite.
LOCKSTEP_API void require_finite(const char* law, const char* key, double value);
/// Calls reject() unless `value` is finite and above 0.
LOCKSTEP_API void require_positive(const char* law, const char* key, double value);
/// Calls reject() when there is no law.
template <class L>
inline void require_law(const char* law, const char* key, const std::shared_ptr<L>& inner) {
  if (!inner) reject(law, key, "is null; give a law");
}
/// `axis` scaled to length 1. Calls reject() when it is zero or not finite.
LOCKSTEP_API Vec3 require_direction(const char* law, const char* key, const Vec3& axis);
/// `q` scaled to length 1. Calls reject() when it is zero or not finite.
LOCKSTEP_API Quat require_orientation(const char* law, const char* key, const Quat& q);

}  // namespace lockstep
