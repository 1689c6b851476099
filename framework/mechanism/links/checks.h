// SPDX-License-Identifier: BSD-3-Clause
// What joints check of laws and numbers that they are given.
#pragma once

#include <cmath>
#include <string>

#include <lockstep/author/law.h>
#include <lockstep/error.h>
#include <lockstep/text.h>

namespace lockstep {

/// The law. Throws ModelError without one; `what`: "law for its radius".
template <class Law>
LawPtr<Law> given(const std::string& joint, LawPtr<Law> law, const std::string& what) {
  if (!law) throw ModelError("joint '" + joint + "': no " + what + " was given; give one");
  return law;
}

/// The number. Throws ParameterError unless it is finite and `ok`; `rule` follows it: " m; it must not be negative".
inline double checked(const std::string& joint, const char* key, double x, bool ok, const char* rule) {
  if (ok && std::isfinite(x)) return x;
  throw ParameterError({.kind = "joint", .name = joint}, key, "is " + text::brief(x) + rule);
}

}  // namespace lockstep
