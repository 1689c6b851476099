// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// @file The solver `schur` on the random matrices of random_kkt.h: masses of any form become 1 by a change of
/// unknowns, M = L L^T, a' = L^T a, J' = J L^-T, so that the solver's own rows and masses can carry them.

#include <Eigen/Cholesky>

#include <lockstep/solvers.h>
#include "tests/support/random_kkt.h"

namespace lockstep::test {

/// Widths 6 and 3 only; a slot of width 3 has no turn.
class SchurOnKktFactorization final : public Factorization {
 public:
  explicit SchurOnKktFactorization(const KktPattern& pattern) {
    Kkt& k = kkt_;
    const auto n = static_cast<int>(pattern.width.size());
    for (const KktLink& link : pattern.links) {
      RowEntry e;
      e.link = link.link, e.m = link.m, e.kind = link.kind;
      for (int i = 0; i < link.n_slots; ++i) e.slots.add(link.slot[i]);
      rows_.entries.push_back(e);
    }
    rows_.lay_out();
    k.pattern.rows = &rows_;
    k.pattern.width.assign(n, 6);
    k.pattern.n = 6 * n, k.pattern.m = rows_.n_rows;
    for (int s = 0; s < n; ++s) k.masses.push_back({1.0, Mat3::Identity(), pattern.width[s] == 3});
    inner_ = SchurSolver().analyse(k.pattern);
  }

  void compute(const Kkt& given) override {
    L_.clear();
    for (std::size_t s = 0; s < given.pattern.width.size(); ++s) {
      const int w = given.pattern.width[s];
      MatX M(w, w);
      for (int i = 0; i < w; ++i)
        for (int j = 0; j < w; ++j) M(i, j) = given.M[given.pattern.M[s] + (i * w + j)];
      L_.push_back(M.llt().matrixL());
    }
    for (std::size_t l = 0; l < given.pattern.links.size(); ++l) {
      const KktLink& link = given.pattern.links[l];
      const RowBlock block = rows_.block(rows_.entries[l]);
      std::size_t at = link.J;
      for (int i = 0; i < link.n_slots; ++i) {
        const MatX& L = L_[link.slot[i]];
        for (int j = 0; j < link.m; ++j, at += static_cast<std::size_t>(L.rows())) {
          VecX row = VecX::Zero(6);
          row.head(L.rows()) =
              L.triangularView<Eigen::Lower>().solve(Eigen::Map<const VecX>(given.J.data() + at, L.rows()));
          block.set(i, j, Vec3(row.head<3>()), Vec3(row.tail<3>()));
        }
      }
    }
    kkt_.redundant = given.redundant;
    inner_->compute(kkt_);
  }

  SolveReport solve(const Kkt& given, const VecX& f, const VecX& c, VecX& a, VecX& lambda) override {
    VecX f6 = VecX::Zero(kkt_.pattern.n), a6;
    for (std::size_t s = 0; s < L_.size(); ++s)
      f6.segment(6 * static_cast<int>(s), L_[s].rows()) =
          L_[s].triangularView<Eigen::Lower>().solve(f.segment(given.pattern.first[s], L_[s].rows()));
    SolveReport report = inner_->solve(kkt_, f6, c, a6, lambda);
    inner_->complete(report);
    a.resize(given.pattern.n);
    for (std::size_t s = 0; s < L_.size(); ++s)
      a.segment(given.pattern.first[s], L_[s].rows()) =
          L_[s].transpose().triangularView<Eigen::Upper>().solve(a6.segment(6 * static_cast<int>(s), L_[s].rows()));
    return report;
  }

 private:
  std::unique_ptr<Factorization> inner_;
  RowTable rows_;
  Kkt kkt_;
  std::vector<MatX> L_;
};

class SchurOnKkt final : public LinearSolver {
 public:
  std::string_view name() const override { return "schur"; }
  std::unique_ptr<Factorization> analyse(const KktPattern& pattern) const override {
    return std::make_unique<SchurOnKktFactorization>(pattern);
  }
};

}  // namespace lockstep::test
