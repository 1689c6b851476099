// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/body.h>

#include <Eigen/Cholesky>
#include <algorithm>

namespace lockstep {

BodyMass::BodyMass(double m, const Mat3& J, bool particle, Plane plane) : m_(m), particle_(particle), plane_(plane) {
  if (particle) return;
  J_ = J;
  if (plane)
    inverse_J_(plane.n, plane.n) = 1.0 / J(plane.n, plane.n);
  else
    inverse_J_ = J.llt().solve(Mat3::Identity());
}

void BodyMass::write_blocks(double* M, double* inverse) const {
  const int n = width(), n_linear = plane_ ? 2 : 3;
  for (double* block : {M, inverse}) std::fill_n(block, n * n, 0.0);
  for (int i = 0; i < n_linear; ++i) M[(n + 1) * i] = m_, inverse[(n + 1) * i] = 1.0 / m_;
  for (int i = n_linear; i < n; ++i)
    for (int k = n_linear; k < n; ++k) {
      const int row = plane_ ? plane_.n : i - 3, column = plane_ ? plane_.n : k - 3;
      M[n * i + k] = J_(row, column), inverse[n * i + k] = inverse_J_(row, column);
    }
}

void BodyMass::write_packed(double* M, double* inverse) const {
  *M++ = m_, *inverse++ = 1.0 / m_;
  if (plane_) {
    *M = J_(plane_.n, plane_.n), *inverse = inverse_J_(plane_.n, plane_.n);
    return;
  }
  for (int i = 0; i < 3; ++i)
    for (int k = i; k < 3; ++k) *M++ = J_(i, k), *inverse++ = inverse_J_(i, k);
}

}  // namespace lockstep
