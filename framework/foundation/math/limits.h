// SPDX-License-Identifier: BSD-3-Clause
// What counts as nothing: three floors, each relative to what it is compared with.
#pragma once

namespace lockstep {

/// Of the terms of a sum by their size: what rounding leaves where they cancel, 2^-53 of some thousand terms.
inline constexpr double kRoundOff = 1e-12;
/// Of the largest of a kind, a force, a length, an inertia, a mode: what a solution of equations leaves of a zero, when
/// some digits of a double are lost.
inline constexpr double kNegligible = 1e-9;
/// Of what two are compared by, loads, speeds, motions, derivatives by differences: smaller is no part, and two that
/// differ by less are alike. Half of the digits of a double, with two to spare.
inline constexpr double kSlight = 1e-6;

}  // namespace lockstep
