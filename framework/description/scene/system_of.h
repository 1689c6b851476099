// SPDX-License-Identifier: BSD-3-Clause
// The system of a mechanism, for what is built on it inside the library.
#pragma once

#include <lockstep/scene.h>

namespace lockstep {

/// To be changed, evaluated and run.
inline System& system_of(HeldSystem& held) { return held.own_; }

}  // namespace lockstep
