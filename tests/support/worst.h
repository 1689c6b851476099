// SPDX-License-Identifier: BSD-3-Clause
// The worst of many differences, which a NaN among them does not pass unseen.
#pragma once

#include <cmath>

namespace lockstep {

/// worst = the larger of both; a NaN stays, whichever came first, so that every limit on `worst` fails. std::max drops it.
inline void keep_worst(double& worst, double x) {
  if (!(x <= worst) && !std::isnan(worst)) worst = x;
}

}  // namespace lockstep
