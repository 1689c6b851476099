// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/stepping.h>

namespace lockstep {

Weights::Weights(const double* all, int n_all) {
  for (int i = 0; i < n_all; ++i) {
    if (all[i] == 0) continue;
    stage[n] = i;
    w[n++] = all[i];
  }
}

}  // namespace lockstep
