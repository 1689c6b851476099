// SPDX-License-Identifier: BSD-3-Clause
// Orientations whose quaternion is not of length 1.
#pragma once

#include <string>

#include <lockstep/author/params.h>
#include <lockstep/detail/export.h>
#include <lockstep/math.h>

namespace lockstep {

/// read_orientation() of read.h, which warns of a quaternion that is off length 1 by more than rounding leaves.
LOCKSTEP_API Quat read_orientation_told(const Value&, const std::string& context);

}  // namespace lockstep
