// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/params.h>

#include <cmath>

#include <lockstep/error.h>

namespace lockstep {
namespace {

constexpr double kGimbal = 1e-7;  // rad

// Axes i, j, k of a sequence; m is the axis that is neither i nor j; sign is 1 if i, j, m are right-handed, else -1.
struct Axes {
  int i, j, k, m;
  double sign;
};

Axes axes_of(const std::string& name) {
  const std::string s = angle_sequence(name);
  if (s.size() != 3 || s.find_first_not_of("xyz") != std::string::npos || s[0] == s[1] || s[1] == s[2])
    throw ModelError("angle sequence \"" + name +
                     "\": expected three letters of x, y, z without two equal neighbours, or \"cardan\" (xyz), "
                     "\"euler\" (zxz), \"hpb\" (zxy)");
  const int i = s[0] - 'x', j = s[1] - 'x', k = s[2] - 'x';
  return {i, j, k, 3 - i - j, (j - i + 3) % 3 == 1 ? 1.0 : -1.0};
}

double wrapped(double angle) {
  const double a = std::remainder(angle, kTwoPi);
  return a == -kPi ? kPi : a;
}

}  // namespace

std::string angle_sequence(const std::string& name) {
  if (name == "cardan") return "xyz";
  if (name == "euler") return "zxz";
  if (name == "hpb") return "zxy";
  return name;
}

Quat from_angles(const std::string& sequence, const Vec3& angles) {
  const Axes n = axes_of(sequence);
  return axis_angle(Vec3::Unit(n.i), angles[0]) * axis_angle(Vec3::Unit(n.j), angles[1]) *
         axis_angle(Vec3::Unit(n.k), angles[2]);
}

// With axes i, j, i and sign e of (i, j, m), the product of three turns a, b, c has the components
//   q0 = cos b/2 cos (a+c)/2,  qi = cos b/2 sin (a+c)/2,  qj = sin b/2 cos (a-c)/2,  qm = e sin b/2 sin (a-c)/2.
// For i, j, k all different, turning j by -e pi/2 takes axis i to axis k, so that q times that turn is an i, j, i
// product whose middle angle is b - e pi/2, of the sign of -e.
Angles to_angles(const std::string& sequence, const Quat& given) {
  const Axes n = axes_of(sequence);
  const bool distinct = n.i != n.k;
  const double shift = distinct ? -n.sign * kPi / 2 : 0.0;
  const double side = distinct ? -n.sign : 1.0;  // sign of the middle angle
  const Quat q = normalized(distinct ? given * axis_angle(Vec3::Unit(n.j), shift) : given);

  const Vec3 v = q.vec();
  const double cos_half = std::hypot(q.w, v[n.i]), sin_half = std::hypot(v[n.j], v[n.m]);
  const double middle = 2 * std::atan2(sin_half, cos_half);
  const double half_sum = std::atan2(v[n.i], q.w);
  const double half_difference = std::atan2(side * n.sign * v[n.m], side * v[n.j]);

  Angles r;
  r.value[1] = side * middle - shift;
  r.gimbal = middle < kGimbal || kPi - middle < kGimbal;
  if (r.gimbal) {  // only the sum (or difference) of the outer angles is defined: the first takes it all
    r.value[0] = wrapped(2 * (middle < kGimbal ? half_sum : half_difference));
  } else {
    r.value[0] = wrapped(half_sum + half_difference);
    r.value[2] = wrapped(half_sum - half_difference);
  }
  return r;
}

}  // namespace lockstep
