// SPDX-License-Identifier: BSD-3-Clause
// Largest: the largest accelerations of the slots, as they are found one by one.
#pragma once

#include <algorithm>
#include <cmath>

#include <lockstep/detail/export.h>

namespace lockstep {

struct Largest {
  double a2 = 0, al2 = 0;  ///< their squares

  LOCKSTEP_INLINE void add(double own_a2, double own_al2) { a2 = std::max(a2, own_a2), al2 = std::max(al2, own_al2); }
  double a() const { return std::sqrt(a2); }       ///< m/s^2
  double alpha() const { return std::sqrt(al2); }  ///< angular, rad/s^2
};

}  // namespace lockstep
