// How a law refuses what it is given: one test serves the C++ constructor (ModelError) and the maker (SceneError with
// place).
#pragma once

#include <cmath>
#include <string>
#include <utility>

#include "framework/mechanism/params/params.h"
#include "framework/foundation/support/error.h"
#include "framework/foundation/support/text.h"

namespace lockstep {

/// A parameter of a law that cannot be; `key` is its name in the law's table of keys.
class LOCKSTEP_API BadParameter : public ModelError {
 public:
  BadParameter(const std::string& law, std::string its_key, std::string its_problem)
      : ModelError("law '" + law + "': " + its_key + " " + its_problem),
        key(std::move(its_key)),
        problem(std::move(its_problem)) {}
  std::string key, problem;
};

/// Throws BadParameter unless `ok`; `problem` follows the key: "is -1; must be above 0".
inline void require(bool ok, const char* law, const char* key, const std::string& problem) {
  if (!ok) throw BadParameter(law, key, problem);
}
inline void require_finite(const char* law, const char* key, double value) {
  if (!std::isfinite(value)) throw BadParameter(law, key, "is " + number(value) + "; must be a finite number");
}
inline void require_positive(const char* law, const char* key, double value) {
  if (!(std::isfinite(value) && value > 0)) throw BadParameter(law, key, "is " + number(value) + "; must be above 0");
}
template <class L>
inline void require_law(const char* law, const char* key, const std::shared_ptr<L>& inner) {
  if (!inner) throw BadParameter(law, key, "is null; give a law");
}
/// `axis` at length 1; throws BadParameter when it is zero or not finite.
inline Vec3 require_direction(const char* law, const char* key, const Vec3& axis) {
  const double most = axis.cwiseAbs().maxCoeff();
  if (!axis.allFinite()) throw BadParameter(law, key, "holds a number that is not finite; give a direction");
  if (most == 0) throw BadParameter(law, key, "is [0, 0, 0], which is no direction; give one that is not zero");
  return (axis / most).normalized();
}
/// `q` at length 1; throws BadParameter when it is zero or not finite.
inline Quat require_orientation(const char* law, const char* key, const Quat& q) {
  const Vec4 c = q.coefficients();
  const double most = c.cwiseAbs().maxCoeff();
  if (!c.allFinite()) throw BadParameter(law, key, "holds a number that is not finite; give a quaternion");
  if (most == 0)
    throw BadParameter(law, key, "is [0, 0, 0, 0], which is no orientation; [1, 0, 0, 0] is the unturned one");
  return normalized(Quat::from(Vec4(c / most)));
}

/// What `make` makes of `p`; a BadParameter is refused at the place of its key.
template <class F>
auto built(const Params& p, F make) -> decltype(make()) {
  try {
    return make();
  } catch (const BadParameter& e) {
    p.refuse(e.key, e.problem);
  }
}

}  // namespace lockstep
