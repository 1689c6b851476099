// SPDX-License-Identifier: BSD-3-Clause
// Looks at states that are no work of a run.
#pragma once

#include <lockstep/dynamics.h>
#include "framework/foundation/support/at_end.h"

namespace lockstep {

/// Gives the counters of work back when it ends: what was looked at in between, as for pictures, does not count.
inline auto uncounted(Dynamics& dynamics) {
  return AtEnd([&work = dynamics.work(), before = dynamics.work()] { work = before; });
}

}  // namespace lockstep
