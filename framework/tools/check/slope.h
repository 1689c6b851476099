// SPDX-License-Identifier: BSD-3-Clause
// Derivatives by differences, with an estimate of their error from the same numbers.
//
//   f'(0)  = (1/h)   sum_k  a_k (f(kh) - f(-kh)),          k = 1 ... 4: error h^8
//   f''(0) = (1/h^2) sum_k  b_k (f(kh) - 2 f(0) + f(-kh))
//
// for steps h = reach/4, reach/8, ...: the difference to order 6 is the truncation, and the eighth difference of
// the finest step, where nothing smooth is left, the rounding noise of f. Of each component the step with the least sum
// of both is taken.
#pragma once

#include <functional>

#include <lockstep/math.h>

namespace lockstep {

/// f(x), always of one size.
using Curve = std::function<VecX(double x)>;

/// Component by component: the derivative, and a bound for its error (several times the estimate).
struct Slope {
  VecX value, error;
};

/// At x = 0, from values in [-reach, reach]. Components that are not finite somewhere have an infinite error.
LOCKSTEP_API Slope first_derivative(const Curve&, double reach);
LOCKSTEP_API Slope second_derivative(const Curve&, double reach);

}  // namespace lockstep
