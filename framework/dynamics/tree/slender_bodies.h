// SPDX-License-Identifier: BSD-3-Clause
// Where rounding makes joint coordinates the worse ones.
#pragma once

#include <string>
#include <vector>

#include <lockstep/detail/export.h>
#include <lockstep/finding.h>

namespace lockstep {

class JointTree;
class System;

/// A body that turns freely about all axes, and carries by arms up to r a mass m on its least principal inertia J, in a
/// tree in space: "" if m r^2 <= `most` J for all of them, else the one with the most m r^2 / J. Its turn about that
/// axis comes out of sums whose terms are as large as m r^2, with a relative error of 1e-16 m r^2 / J, which at tight
/// tolerances no step brings below the tolerance; omega finds it from the body's own inertia.
LOCKSTEP_API std::string slender_body(const JointTree&, const System&, double most = 1e6);

/// The m r^2 / J from which on steps grow short by it at this relative tolerance: a rounding of 2^-52 makes half of that. A
/// chain of four rods on balls took 2 to 3 times the steps of omega at a tenth of it, a hundred times at a quarter.
constexpr double slenderness_at(double tolerance) { return 0x1p51 * tolerance; }

/// Bodies in space whose least principal inertia J is below what rounding leaves of m r^2, of their own mass and the farthest
/// of their markers: nothing finds their rotation about that axis to the default tolerance. Not those that joints hold there
/// on the ground, or on bodies which are not lost.
LOCKSTEP_API std::vector<Finding> lost_inertias(const System&);

}  // namespace lockstep
