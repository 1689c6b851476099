// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/math.h>

namespace lockstep {

bool are_parallel(const Vec3& a, const Vec3& b) { return cross(a, b).norm() <= kParallel; }
bool are_perpendicular(const Vec3& a, const Vec3& b) { return std::abs(a.dot(b)) <= kParallel; }

// (1.12)
Quat exponential(const Vec3& th) {
  const double a2 = th.squaredNorm();
  double c, s;  // cos(a/2), sin(a/2)/a
  if (a2 < 1e-4) {
    c = 1.0 - a2 / 8.0 * (1.0 - a2 / 48.0 * (1.0 - a2 / 120.0));
    s = 0.5 * (1.0 - a2 / 24.0 * (1.0 - a2 / 80.0 * (1.0 - a2 / 168.0)));
  } else {
    const double a = std::sqrt(a2);
    c = std::cos(0.5 * a);
    s = std::sin(0.5 * a) / a;
  }
  return {c, s * th[0], s * th[1], s * th[2]};
}

Quat axis_angle(const Vec3& n, double angle) {
  const double s = std::sin(0.5 * angle) / n.norm();
  return {std::cos(0.5 * angle), s * n[0], s * n[1], s * n[2]};
}

Quat quaternion_of(const Mat3& A) {
  const double t = A.trace();
  int k = 0;
  double most = t;
  for (int i = 0; i < 3; ++i)
    if (A(i, i) > most) most = A(i, i), k = i + 1;
  Quat q;
  if (k == 0) q = {1.0 + t, A(2, 1) - A(1, 2), A(0, 2) - A(2, 0), A(1, 0) - A(0, 1)};
  if (k == 1) q = {A(2, 1) - A(1, 2), 1.0 + 2.0 * A(0, 0) - t, A(0, 1) + A(1, 0), A(0, 2) + A(2, 0)};
  if (k == 2) q = {A(0, 2) - A(2, 0), A(0, 1) + A(1, 0), 1.0 + 2.0 * A(1, 1) - t, A(1, 2) + A(2, 1)};
  if (k == 3) q = {A(1, 0) - A(0, 1), A(0, 2) + A(2, 0), A(1, 2) + A(2, 1), 1.0 + 2.0 * A(2, 2) - t};
  return normalized(q);
}

Pose operator*(const Pose& a, const Pose& b) { return {a.x + rotation(a.q) * b.x, a.q * b.q}; }

Pose inverse(const Pose& a) { return {-(rotation(a.q).transpose() * a.x), conjugate(a.q)}; }

}  // namespace lockstep
