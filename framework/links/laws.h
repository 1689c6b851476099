// What links with laws of their own have in common.
#pragma once

#include <cmath>
#include <string>

#include "framework/model/motion_law.h"

namespace lockstep {

/// `words` when the law is not finite at time t, else nothing; for Lock::blame.
inline std::string blame_law(const LawPtr<MotionLaw>& law, double t, const char* words) {
  if (!law) return {};
  const LawValue l = law->at(t);
  return std::isfinite(l.y) && std::isfinite(l.yd) && std::isfinite(l.ydd) ? "" : words;
}

}  // namespace lockstep
