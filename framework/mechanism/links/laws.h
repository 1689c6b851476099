// What links with laws of their own have in common.
#pragma once

#include <string>

#include "framework/mechanism/model/law_fault.h"

namespace lockstep {

/// `words` and what is wrong with the law at time t; "" when nothing is; for Lock::blame.
inline std::string blame_law(const LawPtr<MotionLaw>& law, double t, const char* words) {
  return law ? law_fault(words, *law, t) : "";
}

}  // namespace lockstep
