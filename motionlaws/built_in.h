// SPDX-License-Identifier: BSD-3-Clause
// Private to the room: laws that cannot be evaluated have their origin in the error.
#pragma once

#include <lockstep/error.h>

namespace lockstep {

/// Calls `act`; an Error that it throws has the law of this type, built in, as its thing. So a run that goes beyond the
/// end of a spline differs from exceptions of user code. Costs nothing unless something is thrown.
template <class Act>
void as_built_in_law(const char* type, Act&& act) {
  in_context([&] { return ErrorContext{.thing = {.kind = "law", .type = type, .origin = "built in"}}; }, act);
}

}  // namespace lockstep
