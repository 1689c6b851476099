// SPDX-License-Identifier: BSD-3-Clause
// The points that circles or lines have in common, for meet(...) in formulas.
#pragma once

#include <string>

#include <lockstep/math.h>

namespace lockstep::expression {

/// A common point, SI.
struct Meeting {
  Vec3 at = Vec3::Zero();
  std::string problem{};  ///< why there is none, and the next move; "" if there is one
};

/// Of the circles about A and B normal to an axis: the point to the left of the line from A to B, as seen against the
/// axis, if side > 0, to the right if side < 0.
Meeting meeting_of_circles(const Vec3& A, double r, const Vec3& B, double s, double side, const Vec3& axis);
/// Of the line through A and B and that through C and D, in any plane.
Meeting meeting_of_lines(const Vec3& A, const Vec3& B, const Vec3& C, const Vec3& D);

}  // namespace lockstep::expression
