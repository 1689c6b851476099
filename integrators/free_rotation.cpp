#include "integrators/free_rotation.h"

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
  const double a = t * p[k] / J_[k], c = std::cos(a), s = std::sin(a);
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const double pi = p[i], pj = p[j];
  p[i] = c * pi + s * pj;
  p[j] = c * pj - s * pi;
  Vec3 turn = Vec3::Zero();
  turn[k] = a;
  e = e * exponential(turn);
}

}  // namespace lockstep
