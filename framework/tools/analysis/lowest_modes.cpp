// SPDX-License-Identifier: BSD-3-Clause
// Davidson's method. The modes x of the mechanism in a basis V of some motions have residuals
//
//   r = (l^2 M + l D + K) x + J^T lambda
//
// and what S, the solution on the constraints with K + s D + s^2 M, makes of them leads to better ones:
//
//   S r = x + S ( (l^2 - s^2) M x + (l - s) D x )
//
// It is added to V until it is round-off. V begins with as many motions as modes are asked for, so that equal modes are
// found with all their copies.
#include "framework/tools/analysis/spectrum.h"

#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <random>

#include <lockstep/error.h>
#include "framework/foundation/math/limits.h"
#include "framework/foundation/math/sparse.h"
#include "framework/tools/analysis/minimal_coordinates.h"

namespace lockstep {
namespace {

using Complex = std::complex<double>;
using Eigen::VectorXcd;

// Of the largest number of A: below what regular rows leave in the Schur complement, above its round-off.
constexpr double kProximal = 1e-10;

// The sparse factor of a saddle-point matrix, for solutions on the constraints.
//
//   | A  J^T | | x |   | f |
//   | J  -E  | | l | = | 0 |      E: proximal term for redundant rows, corrected away
class SaddleFactor {
 public:
  // Of A, unknowns x unknowns, with the rows J of the mechanism. `redundant`: whether rows depend on one another; E is zero
  // otherwise. Throws SolveError for a singular matrix.
  SaddleFactor(const MechanismMatrices& m, const SparseMat& A, bool redundant) : scale_(lengths_of(m).cwiseInverse()) {
    const Eigen::Index n = A.rows(), rows = m.J.rows();
    const SparseMat scaled = lockstep::scaled(scale_, A, scale_);
    const SparseMat Jt = lockstep::scaled(scale_, m.J.transpose());
    double size = n > 0 ? VecX(scaled.diagonal()).cwiseAbs().maxCoeff() : 0;
    if (size == 0) size = 1;

    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index j = 0; j < n; ++j)
      for (SparseMat::InnerIterator it(scaled, j); it; ++it) entries.emplace_back(it.row(), j, it.value());
    for (Eigen::Index row = 0; row < rows; ++row) {
      const double length = Jt.col(row).norm(), to = length > 0 ? size / length : 0.0;
      for (SparseMat::InnerIterator it(Jt, row); it; ++it) {
        entries.emplace_back(it.row(), n + row, to * it.value());
        entries.emplace_back(n + row, it.row(), to * it.value());
      }
    }
    matrix_.resize(n + rows, n + rows);
    matrix_.setFromTriplets(entries.begin(), entries.end());
    sizes_ = matrix_.cwiseAbs();
    for (Eigen::Index row = n; redundant && row < n + rows; ++row) entries.emplace_back(row, row, -kProximal * size);
    SparseMat with_proximal(n + rows, n + rows);
    with_proximal.setFromTriplets(entries.begin(), entries.end());
    lu_.compute(with_proximal);
    if (lu_.info() != Eigen::Success)
      throw SolveError("the saddle-point matrix of the linear equations has no factors: " + lu_.lastErrorMessage());
  }

  // x for this f: on the constraints. Throws SolveError if x is not finite, or solves the equations to less than 1e-9.
  // Corrected as long as that helps: a long loop of joints lets the proximal term go slowly.
  VecX solve(const VecX& f) const {
    if (f.isZero(0)) return f;
    const Eigen::Index n = scale_.size();
    VecX b = VecX::Zero(matrix_.rows());
    b.head(n) = scale_.cwiseProduct(f);
    VecX x = VecX::Zero(b.size()), left = b;
    double error = 1;  // relative to the largest terms
    while (error > std::numeric_limits<double>::epsilon()) {
      const VecX next = x + lu_.solve(left), next_left = b - matrix_ * next;
      const double now = next_left.lpNorm<Eigen::Infinity>() / (b.cwiseAbs() + sizes_ * next.cwiseAbs()).maxCoeff();
      if (!(now < 0.7 * error)) break;
      x = next, left = next_left, error = now;
    }
    if (!(error <= kNegligible))
      throw SolveError("the sparse matrix of the linear equations is ill-conditioned: the relative residual is " +
                       std::to_string(error) + "; use a dense solution (dense_limit)");
    return scale_.cwiseProduct(x.head(n));
  }

 private:
  VecX scale_;        // of the unknowns
  SparseMat matrix_,  // without E, in scaled unknowns and rows
      sizes_;         // of its entries
  Eigen::SparseLU<SparseMat> lu_;
};

// Motions that are orthonormal in M.
class Motions {
 public:
  explicit Motions(const SparseMat& M) : M_(&M), V_(M.rows(), 0) {}

  const MatX& all() const { return V_; }
  double norm(const VectorXcd& x) const {
    return std::sqrt(std::max(x.real().dot(*M_ * x.real()) + x.imag().dot(*M_ * x.imag()), 0.0));
  }
  // Adds what is new in it, put back onto the constraints, from which its length takes it otherwise.
  template <class Constrained>
  void add(const VectorXcd& x, Constrained&& constrained) {
    for (const VecX& part : {VecX(x.real()), VecX(x.imag())}) {
      const VecX is_new = new_part(constrained(new_part(part)));
      if (is_new.isZero(0)) continue;
      V_.conservativeResize(Eigen::NoChange, V_.cols() + 1);
      V_.rightCols(1) = is_new;
    }
  }

 private:
  VecX new_part(VecX x) const {
    const double before = norm(x.cast<Complex>());
    for (int twice = 0; twice < 2; ++twice) x -= V_ * (V_.transpose() * (*M_ * x));
    const double left = norm(x.cast<Complex>());
    return left > kNegligible * before ? VecX(x / left) : VecX(VecX::Zero(x.size()));
  }

  const SparseMat* M_;
  MatX V_;
};

// The rate of what acts most on one unknown by itself, 1/s: above all others, nearly.
double largest_rate(const LinearMotion& m) {
  double rate = 0;
  for (Eigen::Index i = 0; i < m.M.rows(); ++i)
    if (const double mass = m.M.coeff(i, i); mass > 0)
      rate = std::max({rate, std::sqrt(std::abs(m.K.coeff(i, i)) / mass), std::abs(m.D.coeff(i, i)) / mass});
  return rate;
}

}  // namespace

MatX lowest_motions(const LinearMotion& m, int count, bool redundant) {
  const Eigen::Index most = 200 + 20 * count;
  std::mt19937 random{1};
  std::normal_distribution<double> normal;
  Motions V(m.M);
  double s = largest_rate(m);
  if (!(s > 0)) s = 1;  // nothing acts: every eigenvalue is zero
  for (int start = count;;) {
    const SparseMat K_s = m.K + s * m.D + s * s * m.M;
    const SaddleFactor S(m, K_s, redundant);
    const auto constrained = [&](const VecX& x) { return S.solve(K_s * x); };
    for (int k = 0; k < start; ++k)
      V.add(S.solve(m.M * VecX(VecX::NullaryExpr(m.M.rows(), [&] { return normal(random); }))).cast<Complex>(),
            constrained);
    start = 0;
    for (;;) {
      std::vector<Eigenvalue> lowest = spectrum_of(m, V.all()).all;  // zeros first
      const auto first = std::ranges::find_if(lowest, [](const Eigenvalue& e) { return e.l != 0.0; });
      const double rate = first != lowest.end() ? std::abs(first->l) : HUGE_VAL;
      if (lowest.size() > static_cast<std::size_t>(count)) lowest.erase(lowest.begin() + count, lowest.end());
      Motions wanted(m.M);
      for (const Eigenvalue& e : lowest) wanted.add(e.x, constrained);
      if (s > 2 * rate) {  // on with a shift below the lowest
        s = 0.5 * rate, V = wanted;
        break;
      }
      const Eigen::Index before = V.all().cols();
      for (const auto& [l, bound, x] : lowest) {
        const VectorXcd f = (l * l - s * s) * (m.M * x) + (l - s) * (m.D * x);
        VectorXcd better = x;
        better.real() += S.solve(f.real()), better.imag() += S.solve(f.imag());
        if (V.norm(better) > std::max(kNegligible, kRoundOff * std::norm(l / s)) * V.norm(x))
          V.add(better, constrained);
      }
      if (V.all().cols() == before) return m.D.norm() == 0 ? wanted.all() : V.all();  // damped, l has no x of its own
      if (V.all().cols() > most)
        throw SolveError("the lowest " + std::to_string(count) + " eigenvalues did not converge in " +
                         std::to_string(most) + " steps; request fewer, or a dense solution (dense_limit)");
    }
  }
}

}  // namespace lockstep
