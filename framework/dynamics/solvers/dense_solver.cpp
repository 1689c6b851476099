// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/solvers.h>

#include <spdlog/fmt/fmt.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>

#include <lockstep/author/params.h>
#include <lockstep/error.h>
#include "framework/dynamics/solvers/products.h"
#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/foundation/math/decompositions.h"

namespace lockstep {

namespace {

using Qr = Eigen::ColPivHouseholderQR<MatX>;

/// Singular values of B below this fraction of the largest count as zero. Dependent rows agree to rounding (1e-13 and
/// better after the projection); a row that vanishes at a singular position theta rad away leaves about theta.
constexpr double kRankTolerance = 1e-10;
constexpr int kMaxRefinements = 2;

/// A block of M, and in its place L of L L^T, as Eigen::LLT leaves it.
using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

class DenseFactorization final : public Factorization {
 public:
  explicit DenseFactorization(const KktPattern& pattern) {
    const int n = pattern.n, m = pattern.m, k = std::min(n, m);
    L_.assign(pattern.size_M, 0.0);
    Bt_.setZero(n, m);
    Rt_.setZero(m, k);
    outer_ = Qr(n, m);
    inner_ = Qr(m, k);
    outer_.setThreshold(kRankTolerance);
    for (VecX* v : {&y_, &da_, &a_before_}) v->setZero(n);
    for (VecX* v : {&root_E_, &square_, &z_, &t_, &dl_, &l_before_}) v->setZero(m);
    rule_.analyse(pattern);
    watch_.begin(m);
  }

  void compute(const Kkt& kkt) override {
    std::copy_n(kkt.M.begin(), kkt.pattern.size_M, L_.begin());
    for (std::size_t slot = 0; slot < kkt.pattern.width.size(); ++slot)
      if (Eigen::Map<Block> M = block(kkt.pattern, slot); Eigen::LLT<Eigen::Ref<Block>>(M).info() != Eigen::Success)
        throw SolveError(fmt::format(
            "solver dense: the mass matrix of rigid group {} is not positive definite; give its body a mass "
            "and an inertia above zero",
            slot));
    rank_ = 0;
    if (Rt_.cols() == 0) return;
    fill_B(kkt);
    outer_.compute(Bt_);
    // Rows that depend on others on the constraints only are independent beside them, by as little as a stage is off.
    rank_ = static_cast<int>(outer_.rank());
    if (!kkt.nearly) rank_ = std::min(rank_, kkt.pattern.m - std::max(0, kkt.redundant));
    measure_pivots(kkt.redundant);
    Rt_.setZero();
    for (int i = 0; i < rank_; ++i)
      for (Eigen::Index j = i; j < Rt_.rows(); ++j) Rt_(j, i) = outer_.matrixQR()(i, j);
    inner_.compute(Rt_);
  }

  SolveReport solve(const Kkt& kkt, const VecX& f, const VecX& c, VecX& a, VecX& lambda) override {
    a.resize(kkt.pattern.n);
    lambda.resize(kkt.pattern.m);
    SolveReport report;
    rule_.start(kkt, f, c);
    solve_once(kkt, f, c, a, lambda);
    bool met = rule_.met(kkt, f, c, a, lambda);
    while (!met && report.corrections < kMaxRefinements) {
      const double before = rule_.largest();
      a_before_ = a, l_before_ = lambda;
      solve_once(kkt, rule_.force_residual(), rule_.row_residual(), da_, dl_);
      a += da_, lambda += dl_;
      ++report.corrections;
      met = rule_.met(kkt, f, c, a, lambda);
      if (rule_.largest() <= before) continue;
      a = a_before_, lambda = l_before_;  // only rounding: keep the previous solution
      rule_.met(kkt, f, c, a, lambda);
      break;
    }
    report.residual = rule_.largest();
    report.worst_row = rule_.worst_row();
    report.rank = rank_;
    watch_.report(report);
    report.contradictory = rank_ < kkt.pattern.m && watch_.contradictory(rule_.largest(), 0);
    return report;
  }

  void complete(SolveReport& report) override { watch_.report(report); }

 private:
  std::vector<double> L_;  // blocks as in Kkt::M
  MatX Bt_, Rt_;           // B^T (n x m); R1^T (m x min(n, m)), columns from the rank on are zero
  Qr outer_, inner_;       // B^T P1 = Q1 R1;  R1^T P2 = Q2 R2
  VecX root_E_, square_;   // square root of E; squares of the rows of B
  VecX y_, z_, t_;         // n, m, m
  VecX da_, dl_, a_before_, l_before_;
  StopRule rule_;
  PivotWatch watch_;
  int rank_ = 0;

  Eigen::Map<Block> block(const KktPattern& pattern, std::size_t slot) {
    const int width = pattern.width[slot];
    return {&L_[pattern.M[slot]], width, width};
  }

  // x <- L^-1 x and x <- L^-T x.
  void invert_L(const KktPattern& pattern, VecX& x) {
    for (std::size_t k = 0; k < pattern.width.size(); ++k)
      block(pattern, k).triangularView<Eigen::Lower>().solveInPlace(x.segment(pattern.first[k], pattern.width[k]));
  }
  void invert_Lt(const KktPattern& pattern, VecX& x) {
    for (std::size_t k = 0; k < pattern.width.size(); ++k)
      block(pattern, k)
          .transpose()
          .triangularView<Eigen::Upper>()
          .solveInPlace(x.segment(pattern.first[k], pattern.width[k]));
  }

  // B^T = L^-1 J^T E^-1/2, column by column.
  void fill_B(const Kkt& kkt) {
    Bt_.setZero();
    root_E_ = kkt.E.cwiseSqrt();
    for_each_jacobian(kkt.pattern, [&](const KktLink& link, int first, int width, std::size_t at) {
      for (int j = link.first_row; j < link.first_row + link.m; ++j)
        for (int k = 0; k < width; ++k) Bt_(first + k, j) = kkt.J[at++] / root_E_[j];
    });
    for (const KktLink& link : kkt.pattern.links)
      for (int i = 0; i < link.n_slots; ++i) {
        const auto slot = static_cast<std::size_t>(link.slot[i]);
        block(kkt.pattern, slot)
            .triangularView<Eigen::Lower>()
            .solveInPlace(Bt_.block(kkt.pattern.first[slot], link.first_row, kkt.pattern.width[slot], link.m));
      }
  }

  // Pivots R_kk^2 against |b_k|^2: the fraction of a row that the rows before it do not span; zero for rows beyond the n-th.
  void measure_pivots(int redundant) {
    square_ = Bt_.colwise().squaredNorm();
    const auto each = [&](auto&& row) {
      for (Eigen::Index k = 0; k < Bt_.cols(); ++k) {
        const double own = square_[outer_.colsPermutation().indices()[k]];
        const double R = k < Rt_.cols() ? outer_.matrixQR()(k, k) : 0.0;
        row(own > 0.0 ? R * R : 0.0, own > 0.0 ? own : 1.0);
      }
    };
    watch_.see(redundant, each);
  }

  // With t = P1^T c~:
  //   R1^T z = t  in the least-squares sense,   y = Q1 (z, 0),   P1^T mu = Q2 (-R2^-T P2^T z, 0)
  void solve_once(const Kkt& kkt, const VecX& f, const VecX& c, VecX& a, VecX& lambda) {
    a = f;
    invert_L(kkt.pattern, a);
    invert_Lt(kkt.pattern, a);
    if (Rt_.cols() == 0) {
      lambda.setZero();
      return;
    }
    z_.setZero();
    add_rows_times(kkt, a, z_);
    const auto& P1 = outer_.colsPermutation().indices();
    const auto& P2 = inner_.colsPermutation().indices();
    for (Eigen::Index j = 0; j < t_.size(); ++j) t_[j] = (c[P1[j]] - z_[P1[j]]) / root_E_[P1[j]];

    apply_Qt(inner_.matrixQR(), inner_.hCoeffs(), t_);
    const auto R2 = inner_.matrixQR().topLeftCorner(rank_, rank_).triangularView<Eigen::Upper>();
    R2.solveInPlace(t_.head(rank_));
    y_.setZero();
    for (int k = 0; k < rank_; ++k) y_[P2[k]] = t_[k];
    apply_Q(outer_.matrixQR(), outer_.hCoeffs(), y_);
    invert_Lt(kkt.pattern, y_);
    a += y_;

    t_.tail(t_.size() - rank_).setZero();
    t_ = -t_;
    R2.transpose().solveInPlace(t_.head(rank_));
    apply_Q(inner_.matrixQR(), inner_.hCoeffs(), t_);
    for (Eigen::Index j = 0; j < t_.size(); ++j) lambda[P1[j]] = t_[j] / root_E_[P1[j]];
  }
};

TypeInfo DenseSolver::info() {
  return {"dense",
          "rank-revealing QR: exact for redundant constraints, reports the rank; for small systems, as a reference",
          {}};
}
std::unique_ptr<LinearSolver> DenseSolver::make(const Params&) { return std::make_unique<DenseSolver>(); }

std::unique_ptr<Factorization> DenseSolver::analyse(const KktPattern& pattern) const {
  return std::make_unique<DenseFactorization>(pattern);
}

}  // namespace lockstep
