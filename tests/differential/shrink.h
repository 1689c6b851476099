// SPDX-License-Identifier: BSD-3-Clause
// A smaller mechanism that shows the same disagreement.
#pragma once

#include <functional>

#include "tests/differential/design.h"

namespace lockstep::differential {

/// Drops forces, links, bodies, drives, friction, stops, speeds and gravity one by one, as long as `disagrees` still holds.
Design shrunk(Design, const std::function<bool(const Design&)>& disagrees);

}  // namespace lockstep::differential
