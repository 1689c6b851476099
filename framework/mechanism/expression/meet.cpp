// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/expression/meet.h"

#include <algorithm>
#include <cmath>

#include <lockstep/text.h>
#include "framework/foundation/math/limits.h"

namespace lockstep::expression {
namespace {
std::string metres(double x) { return text::brief(x) + " m"; }
Meeting none(const std::string& problem) { return {Vec3::Zero(), problem}; }
}  // namespace

// A + x u + h (e x u), u = B - A, d = |u|, e along the axis: x = (1 + (r^2 - s^2)/d^2)/2,
// h^2 = (r/d)^2 - x^2 = ((r + s)^2 - d^2) (d^2 - (r - s)^2)/(4 d^4), which is 0 where the circles touch.
Meeting meeting_of_circles(const Vec3& A, double r, const Vec3& B, double s, double side, const Vec3& axis) {
  const Vec3 u = B - A, e = axis / axis.norm();
  const double d = u.norm(), most = r + s, least = std::abs(r - s);
  if (std::min(r, s) < 0) return none("a radius is negative: " + metres(std::min(r, s)) + "; give its size");
  if (side == 0 || std::isnan(side)) return none("the side is " + text::brief(side) + "; give left, right, 1 or -1");
  if (d == 0) return none("both centres are at the same point; move one of them");
  if (!e.allFinite()) return none("the axis has no direction; give one, as in [0, 1, 0]");
  if (std::abs(u.dot(e)) > kNegligible * d)
    return none("the centres differ by " + metres(u.dot(e)) +
                " along the axis of the circles, which is z if no other is given; move one of them");
  if (d > most * (1 + kNegligible) || d < least * (1 - kNegligible))
    return none("the circles do not meet: the centres are " + metres(d) + " apart, and the radii " + metres(r) +
                " and " + metres(s) + " need " + metres(least) + " to " + metres(most) +
                "; change a radius, or move a centre");
  const double x = (1 + (r - s) * (r + s) / (d * d)) / 2;
  const double h = std::sqrt(std::max(0.0, (most - d) * (most + d) * (d - least) * (d + least))) / (2 * d * d);
  return {Vec3(A + x * u + std::copysign(h, side) * cross(e, u))};
}

// A + u (w x v).n/n.n, u = B - A, v = D - C, w = C - A, n = u x v; |w.n|/|n| is the distance of the lines.
Meeting meeting_of_lines(const Vec3& A, const Vec3& B, const Vec3& C, const Vec3& D) {
  const Vec3 u = B - A, v = D - C, w = C - A, n = cross(u, v);
  const double size = n.norm(), apart = std::abs(w.dot(n)) / size;
  if (!(size > kNegligible * u.norm() * v.norm()))
    return none("the lines are parallel, or two points of a line coincide; move a point");
  if (apart > kNegligible * (w.norm() + u.norm() + v.norm()))
    return none("the lines do not meet: their least distance is " + metres(apart) +
                "; move a point into the plane of the others");
  return {Vec3(A + cross(w, v).dot(n) / (size * size) * u)};
}

}  // namespace lockstep::expression
