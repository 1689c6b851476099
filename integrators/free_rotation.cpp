// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include <Eigen/Eigenvalues>
#include <cmath>

namespace lockstep {

FreeRotation::FreeRotation(const Mat3& J) : J_(J.diagonal()) {
  if (J.isDiagonal(1e-15)) return;
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(J);
  Mat3 axes = eigen.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
  axes_ = quaternion_of(axes);
  J_ = eigen.eigenvalues();
}

void FreeRotation::turn(double t, Quat& e, Vec3& w) const {
  const Mat3 A = rotation(axes_);
  e = e * axes_;
  Vec3 p = J_.cwiseProduct(A.transpose() * w);
  turn_about(0, 0.5 * t, e, p);
  turn_about(1, 0.5 * t, e, p);
  turn_about(2, t, e, p);
  turn_about(1, 0.5 * t, e, p);
  turn_about(0, 0.5 * t, e, p);
  w = A * p.cwiseQuotient(J_);
  e = e * conjugate(axes_);
}

void FreeRotation::turn_about(int k, double t, Quat& e, Vec3& p) const {
  const double half = 0.5 * t * p[k] / J_[k], c = std::cos(half), s = std::sin(half);
  const double c2 = 1 - 2 * s * s, s2 = 2 * s * c;  // of the whole angle
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const double pi = p[i], pj = p[j];
  p[i] = c2 * pi + s2 * pj;
  p[j] = c2 * pj - s2 * pi;
  const Vec3 v = e.vec();  // e (c, s e_k)
  Vec3 turned = c * v;
  turned[k] += s * e.w;
  turned[i] += s * v[j];
  turned[j] -= s * v[i];
  e = {c * e.w - s * v[k], turned[0], turned[1], turned[2]};
}

}  // namespace lockstep
