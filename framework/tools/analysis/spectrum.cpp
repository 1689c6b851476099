// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/spectrum.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "framework/foundation/math/limits.h"
#include "framework/tools/analysis/minimal_coordinates.h"
#include "framework/tools/analysis/rest_matrices.h"

namespace lockstep {
namespace {

using Complex = std::complex<double>;
using MatXc = Eigen::MatrixXcd;

double largest_row(const MatX& A) { return A.size() == 0 ? 0.0 : A.cwiseAbs().rowwise().sum().maxCoeff(); }

// D = 0, K symmetric: l^2 = -w^2, in which zeros do not split.
void solve_symmetric(const ModalBasis& own, double zero, Spectrum& out) {
  for (Eigen::Index k = 0; k < own.K.rows(); ++k) {
    const double square = own.K(k, k), w = std::sqrt(std::abs(square));
    const auto put = [&](Complex l, double bound) { out.all.push_back({l, bound, own.U.col(k).cast<Complex>()}); };
    if (std::abs(square) <= zero)
      out.zeros += 2, put(0, out.zero_bound);
    else if (square > 0)
      put({0, w}, zero / (2 * w));
    else
      put(-w, zero / (2 * w)), put(w, zero / (2 * w));
  }
}

// x' = A x in x = (z, z'/rate), time in 1/rate, and its zeros taken out level by level: the null space of A gives one
// zero each, that of A without it the second of a direction in which the mechanism can drift, and so on (9.24).
class Companion {
 public:
  Companion(const MatX& K, const MatX& D, double rate, double zero) : zero_(zero), f_(K.rows()) {
    T_ = MatX::Zero(2 * f_, 2 * f_);
    T_.topRightCorner(f_, f_).setIdentity();
    T_.bottomLeftCorner(f_, f_) = -K / (rate * rate);
    T_.bottomRightCorner(f_, f_) = -D / rate;
    Q_ = MatX::Identity(2 * f_, 2 * f_);
    while (deflate()) {
    }
  }
  int zeros() const { return static_cast<int>(done_); }
  MatX null_vectors() const { return Q_.topLeftCorner(f_, first_); }

  // visit(l, z, condition) of the eigenvalues that are left, of pairs one.
  template <class Visit>
  void solve(Visit&& visit) const {
    const Eigen::Index left = T_.rows() - done_;
    if (left == 0) return;
    const auto [values, V] = eigenvectors(T_.bottomRightCorner(left, left));
    const MatXc W = V.partialPivLu().inverse();
    for (Eigen::Index k = 0; k < left; ++k) {
      const Complex l = values[k];
      if (l.imag() < 0) continue;
      Eigen::VectorXcd x(2 * f_);
      x.tail(left) = V.col(k);
      if (done_ > 0) {  // (l 1 - T11) t = T12 w
        const MatXc A = l * MatXc::Identity(done_, done_) - T_.topLeftCorner(done_, done_).cast<Complex>();
        x.head(done_) = A.partialPivLu().solve(T_.topRightCorner(done_, left).cast<Complex>() * V.col(k));
      }
      visit(l, Eigen::VectorXcd((Q_.cast<Complex>() * x).head(f_)), V.col(k).norm() * W.row(k).norm());
    }
  }

 private:
  bool deflate() {
    const Eigen::Index left = T_.rows() - done_;
    if (left == 0) return false;
    const Eigen::BDCSVD<MatX> svd(T_.bottomRightCorner(left, left), Eigen::ComputeFullV);
    const Eigen::Index n_null = (svd.singularValues().array() <= zero_).count();
    if (n_null == 0) return false;
    MatX V(left, left);  // the null space first
    V << svd.matrixV().rightCols(n_null), svd.matrixV().leftCols(left - n_null);
    T_.rightCols(left) = (T_.rightCols(left) * V).eval();
    T_.bottomRows(left) = (V.transpose() * T_.bottomRows(left)).eval();
    T_.block(done_, done_, left, n_null).setZero();
    Q_.rightCols(left) = (Q_.rightCols(left) * V).eval();
    if (done_ == 0) first_ = n_null;
    done_ += n_null;
    return true;
  }

  double zero_;
  Eigen::Index f_, done_ = 0, first_ = 0;
  MatX T_, Q_;
};

}  // namespace

Spectrum spectrum_of(const LinearMotion& m, const MatX& N) {
  Spectrum out;
  if (N.cols() == 0) return out;
  mass_factor(N.transpose() * (m.M * N));
  const ModalBasis own(m.M, m.K, m.K.cwiseAbs(), N);
  const MatX D = own.U.transpose() * (m.D * own.U);
  const VecX sizes = own.U.cwiseAbs().rowwise().sum();
  const double size_D = (own.U.cwiseAbs().transpose() * (SparseMat(m.D.cwiseAbs()) * sizes)).maxCoeff(),
               size_K = largest_row(own.terms), unrest = m.unrest.is_still() ? m.unrest.acceleration / m.length : 0.0,
               zero = kRoundOff * size_K + unrest;
  out.zero_bound = std::sqrt(zero);
  const bool undamped = largest_row(D) <= kRoundOff * std::max(size_D, std::sqrt(size_K)),
             symmetric = largest_row(own.K - own.K.transpose()) <= kRoundOff * size_K;
  if (undamped && symmetric) {
    solve_symmetric(own, zero, out);
  } else {
    // Slow modes err by round-off of A over their share of the rate: it is no faster than K asks for, but as long as
    // round-off of D/rate is negligible relative to 1.
    const double rate =
        std::max({std::sqrt(size_K), std::sqrt(zero), size_D * (std::numeric_limits<double>::epsilon() / kRoundOff)});
    const Companion companion(own.K, D, rate, zero / (rate * rate));
    out.zeros = companion.zeros();
    const MatX rigid = own.U * companion.null_vectors();
    for (const auto& x : rigid.colwise()) out.all.push_back({0, out.zero_bound, x.cast<Complex>()});
    companion.solve([&](Complex share, const Eigen::VectorXcd& z, double condition) {
      const Complex l = rate * share;
      out.all.push_back({l, condition * (kRoundOff * std::max(rate, size_D) + unrest / (2 * std::abs(l))), own.U * z});
    });
  }
  std::ranges::stable_sort(out.all, {}, [](const Eigenvalue& e) { return std::pair(std::abs(e.l), e.l.real()); });
  return out;
}

Eigenvectors eigenvectors(const MatX& A) {
  const Eigen::EigenSolver<MatX> solver(A);
  if (solver.info() != Eigen::Success) throw SolveError("the eigenvalues of a matrix did not converge");
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace lockstep
