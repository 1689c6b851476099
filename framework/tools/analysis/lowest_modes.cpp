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
#include "framework/tools/analysis/lowest_modes.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>

#include <lockstep/error.h>
#include "framework/foundation/math/limits.h"
#include "framework/tools/analysis/saddle_factor.h"
#include "framework/tools/analysis/spectrum.h"

namespace lockstep {
namespace {

using Complex = std::complex<double>;
using Eigen::VectorXcd;

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
