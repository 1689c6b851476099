#include "framework/tools/analysis/spectrum.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <lockstep/error.h>
#include "framework/foundation/math/limits.h"
#include "framework/tools/analysis/minimal_coordinates.h"

namespace lockstep {
namespace {

using Complex = std::complex<double>;
using MatXc = Eigen::MatrixXcd;

// In coordinates z = L^T y, M = L L^T.
struct Normal {
  MatX D, K, L;
  double size_D = 0, size_K = 0;
};

double largest_row(const MatX& A) { return A.size() == 0 ? 0.0 : A.cwiseAbs().rowwise().sum().maxCoeff(); }

Normal normal_of(const QuadraticProblem& p) {
  Normal n;
  n.L = mass_factor(p.M).matrixL();
  const auto lower = n.L.triangularView<Eigen::Lower>();
  const auto both = [&](const MatX& A) {
    const MatX half = lower.solve(A);
    return MatX(lower.solve(MatX(half.transpose())).transpose());
  };
  n.D = both(p.D), n.K = both(p.K);
  const MatX inverse = lower.solve(MatX(MatX::Identity(p.M.rows(), p.M.cols()))).cwiseAbs();
  n.size_D = largest_row(inverse * p.size_D * inverse.transpose());
  n.size_K = largest_row(inverse * p.size_K * inverse.transpose());
  return n;
}

// Of none there are none: Eigen would look at numbers that are not there.
MatX back(const Normal& n, const MatX& z) {
  return z.size() == 0 ? z : MatX(n.L.transpose().triangularView<Eigen::Upper>().solve(z));
}
MatXc back(const Normal& n, const MatXc& z) {
  MatXc y(z.rows(), z.cols());
  if (y.size() == 0) return y;
  y.real() = back(n, MatX(z.real())), y.imag() = back(n, MatX(z.imag()));
  return y;
}

// D = 0, K symmetric: l^2 = -w^2 of a symmetric matrix, in which zeros do not split.
void solve_symmetric(const Normal& n, double zero, double unrest, Spectrum& out) {
  const Eigen::SelfAdjointEigenSolver<MatX> solver(0.5 * (n.K + n.K.transpose()));
  const VecX& squares = solver.eigenvalues();
  std::vector<Eigen::Index> rigid, source;
  for (Eigen::Index k = 0; k < squares.size(); ++k) {
    const double w = std::sqrt(std::abs(squares[k]));
    if (std::abs(squares[k]) <= zero) {
      rigid.push_back(k);
      continue;
    }
    const double bound = (kRoundOff * n.size_K + unrest) / (2 * w);
    const auto put = [&](Complex value) {
      out.values.push_back(value), out.bounds.push_back(bound), source.push_back(k);
    };
    if (squares[k] > 0) {
      put({0, w});
    } else {
      put({-w, 0}), put({w, 0});
    }
  }
  out.zeros = 2 * static_cast<int>(rigid.size());
  out.rigid = back(n, MatX(solver.eigenvectors()(Eigen::all, rigid)));
  const MatX vectors = back(n, MatX(solver.eigenvectors()(Eigen::all, source)));
  out.vectors = vectors.cast<Complex>();
}

// x' = A x in x = (z, z'/rate), time in 1/rate, and its zeros taken out level by level: the null space of A gives one
// zero each, that of A without it the second of a direction in which the mechanism can drift, and so on (9.24).
class Companion {
 public:
  Companion(const Normal& n, double rate, double zero) : zero_(zero), f_(n.K.rows()) {
    T_ = MatX::Zero(2 * f_, 2 * f_);
    T_.topRightCorner(f_, f_).setIdentity();
    T_.bottomLeftCorner(f_, f_) = -n.K / (rate * rate);
    T_.bottomRightCorner(f_, f_) = -n.D / rate;
    Q_ = MatX::Identity(2 * f_, 2 * f_);
    while (deflate()) {
    }
  }
  int zeros() const { return static_cast<int>(done_); }
  int first_level() const { return first_; }
  MatX null_vectors() const { return Q_.topLeftCorner(f_, first_); }

  // The eigenvalues that are left, with vectors (z) and conditions.
  void solve(std::vector<Complex>& values, MatXc& vectors, std::vector<double>& conditions) const {
    const Eigen::Index left = T_.rows() - done_;
    if (left == 0) return;
    const Eigen::EigenSolver<MatX> solver(T_.bottomRightCorner(left, left));
    if (solver.info() != Eigen::Success) throw SolveError("the eigenvalues of the linear equations did not converge");
    const MatXc V = solver.eigenvectors();
    const MatXc W = V.partialPivLu().inverse();
    vectors.resize(f_, left);
    for (Eigen::Index k = 0; k < left; ++k) {
      const Complex l = solver.eigenvalues()[k];
      Eigen::VectorXcd x(2 * f_);
      x.tail(left) = V.col(k);
      if (done_ > 0) {  // (l 1 - T11) t = T12 w
        const MatXc A = l * MatXc::Identity(done_, done_) - T_.topLeftCorner(done_, done_).cast<Complex>();
        x.head(done_) = A.partialPivLu().solve(T_.topRightCorner(done_, left).cast<Complex>() * V.col(k));
      }
      values.push_back(l);
      vectors.col(k) = (Q_.cast<Complex>() * x).head(f_);
      conditions.push_back(V.col(k).norm() * W.row(k).norm());
    }
  }

 private:
  bool deflate() {
    const Eigen::Index left = T_.rows() - done_;
    if (left == 0) return false;
    const Eigen::BDCSVD<MatX> svd(T_.bottomRightCorner(left, left), Eigen::ComputeFullV);
    const auto n_null = static_cast<Eigen::Index>((svd.singularValues().array() <= zero_).count());
    if (n_null == 0) return false;
    MatX V(left, left);  // the null space first
    V << svd.matrixV().rightCols(n_null), svd.matrixV().leftCols(left - n_null);
    T_.rightCols(left) = (T_.rightCols(left) * V).eval();
    T_.bottomRows(left) = (V.transpose() * T_.bottomRows(left)).eval();
    T_.block(done_, done_, left, n_null).setZero();
    Q_.rightCols(left) = (Q_.rightCols(left) * V).eval();
    if (done_ == 0) first_ = static_cast<int>(n_null);
    done_ += n_null;
    return true;
  }

  double zero_;
  Eigen::Index f_, done_ = 0;
  int first_ = 0;
  MatX T_, Q_;
};

void solve_general(const Normal& n, double zero, double unrest, Spectrum& out) {
  // Slow modes err by round-off of A over their share of the rate: it is no faster than K asks for, but as long as
  // round-off of D/rate is none beside 1.
  const double rate =
      std::max({std::sqrt(n.size_K), std::sqrt(zero), n.size_D * (std::numeric_limits<double>::epsilon() / kRoundOff)});
  if (rate == 0) {  // nothing acts
    out.zeros = 2 * static_cast<int>(n.K.rows());
    out.rigid = back(n, MatX(MatX::Identity(n.K.rows(), n.K.cols())));
    return;
  }
  const Companion companion(n, rate, zero / (rate * rate));
  out.zeros = companion.zeros();
  out.rigid = back(n, companion.null_vectors());
  std::vector<Complex> values;
  std::vector<double> conditions;
  MatXc vectors;
  companion.solve(values, vectors, conditions);
  std::vector<Eigen::Index> kept;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (values[k].imag() < 0) continue;
    kept.push_back(static_cast<Eigen::Index>(k));
    const Complex l = rate * values[k];
    out.values.push_back(l);
    out.bounds.push_back(conditions[k] * (kRoundOff * std::max(rate, n.size_D) + unrest / (2 * std::abs(l))));
  }
  out.vectors = kept.empty() ? MatXc(n.K.rows(), 0) : back(n, MatXc(vectors(Eigen::all, kept)));
}

// By rising |l|; of equal ones by their real parts.
void sort(Spectrum& s) {
  std::vector<std::size_t> order(s.values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    const double A = std::abs(s.values[a]), B = std::abs(s.values[b]);
    return A != B ? A < B : s.values[a].real() < s.values[b].real();
  });
  Spectrum sorted = s;
  for (std::size_t k = 0; k < order.size(); ++k) {
    sorted.values[k] = s.values[order[k]], sorted.bounds[k] = s.bounds[order[k]];
    sorted.vectors.col(static_cast<Eigen::Index>(k)) = s.vectors.col(static_cast<Eigen::Index>(order[k]));
  }
  s = std::move(sorted);
}

}  // namespace

QuadraticProblem problem_in(const LinearMotion& m, const MatX& N) {
  const MatX size = N.cwiseAbs();
  const auto inner = [](const MatX& left, const SparseMat& A) { return MatX(left.transpose() * (A * left)); };
  return {inner(N, m.M),
          inner(N, m.D),
          inner(N, m.K),
          inner(size, SparseMat(m.D.cwiseAbs())),
          inner(size, SparseMat(m.K.cwiseAbs())),
          unrest_share(m)};
}

Spectrum spectrum_of(const QuadraticProblem& p) {
  Spectrum out;
  out.rigid = MatX(p.M.rows(), 0), out.vectors = MatXc(p.M.rows(), 0);
  if (p.M.rows() == 0) return out;
  const Normal n = normal_of(p);
  const double zero = kRoundOff * n.size_K + p.unrest;
  out.zero_bound = std::sqrt(zero);
  const bool undamped = largest_row(n.D) <= kRoundOff * std::max(n.size_D, std::sqrt(n.size_K)),
             symmetric = largest_row(n.K - n.K.transpose()) <= kRoundOff * n.size_K;
  if (undamped && symmetric)
    solve_symmetric(n, zero, p.unrest, out);
  else
    solve_general(n, zero, p.unrest, out);
  sort(out);
  return out;
}

}  // namespace lockstep
