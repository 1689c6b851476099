// SPDX-License-Identifier: BSD-3-Clause
// What the library may answer to anything.
#pragma once

#include <cmath>
#include <exception>
#include <string>

#include <lockstep/error.h>
#include "tests/fuzz/targets.h"

namespace lockstep::fuzz {

/// Calls `act`; an Error of the library is an answer, any other exception breaks the promise.
template <class Act>
void answered(Act&& act) {
  try {
    act();
  } catch (const Error& error) {
    if (std::string(error.what()).empty()) throw Broken{"an error without words"};
    if (error.kind() == Error::Kind::other) throw Broken{std::string("an error of no class: ") + error.what()};
  } catch (const std::exception& error) {
    throw Broken{std::string("a foreign exception: ") + error.what()};
  }
}

/// Throws Broken unless the number is finite.
inline void must_be_finite(double number, const std::string& what) {
  if (!std::isfinite(number)) throw Broken{what + " is not finite"};
}

}  // namespace lockstep::fuzz
