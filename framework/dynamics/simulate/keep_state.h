// SPDX-License-Identifier: BSD-3-Clause
// A copy of a state that survives where memory ends.
#pragma once

#include <lockstep/state.h>

namespace lockstep {

/// to = from. Eigen frees a vector before it asks for one of another size, and points to what is freed where it gets none:
/// then the copy is made first and moved in. Takes no memory if the sizes are the same.
inline void keep_state(const State& from, State& to) {
  const bool fits = to.q.size() == from.q.size() && to.v.size() == from.v.size() && to.s.size() == from.s.size() &&
                    to.z.size() == from.z.size();
  if (fits)
    to = from;
  else
    to = State(from);
}

}  // namespace lockstep
