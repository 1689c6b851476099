// SPDX-License-Identifier: BSD-3-Clause
// Channels of a mechanism in equilibrium: a solver whose solution is known.
#pragma once

#include <cmath>
#include <memory>
#include <string_view>

#include <lockstep/author/solver.h>

namespace lockstep {

/// Returns the multipliers of an equilibrium and no accelerations, so that a Dynamics with it evaluates channels at rest:
/// drives hold their coordinates whatever the rates of their laws are, and friction holds as it was found to.
class SolverAtRest final : public LinearSolver {
 public:
  /// `lambda`: 1 per constraint; it must outlive this.
  explicit SolverAtRest(const VecX& lambda) : lambda_(lambda) {}
  std::string_view name() const override { return "at rest"; }
  bool reads_rows() const override { return true; }
  std::unique_ptr<Factorization> analyse(const KktPattern&) const override { return std::make_unique<Known>(lambda_); }

 private:
  class Known final : public Factorization {
   public:
    explicit Known(const VecX& lambda) : lambda_(lambda) {}
    void compute(const Kkt&) override { solved_ = false; }
    // The loads of friction, which follow, change nothing.
    SolveReport solve(const Kkt&, const VecX& f, const VecX& c, VecX& a, VecX& lambda) override {
      a.setZero(f.size());
      if (solved_) lambda.setZero(c.size());
      if (!solved_) lambda = lambda_;
      solved_ = true;
      SolveReport report;
      report.detector = HUGE_VAL;
      return report;
    }

   private:
    const VecX& lambda_;
    bool solved_ = false;
  };
  const VecX& lambda_;
};

}  // namespace lockstep
