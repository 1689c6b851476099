// StopRule: the residuals of a solution and when they are small enough (framework/docs/solvers.md, section 5). One rule for all
// solvers.
#pragma once

#include <array>

#include "framework/dynamics/solvers/linear_solver.h"

namespace lockstep {

inline constexpr double kRowTolerance = 1e-12;    ///< of the row's scale
inline constexpr double kForceTolerance = 1e-14;  ///< of what the terms of M a + J^T lambda - f amount to
inline constexpr double kScaleFloor = 1e-3;       ///< of the largest scale in the same unit
/// A residual that stalls above this part of its scale is a contradiction. States off the constraints, as the stages of
/// an integrator see them, leave up to some 1e-3 (a step with a larger violation is rejected) and must not be called
/// one.
inline constexpr double kContradiction = 1e-2;
inline constexpr int kMaxCorrections = 3;

class StopRule {
 public:
  void analyse(const KktPattern&);  ///< sizes; all that is allocated
  /// Scales |c| + |J M^-1 f| of the rows, row by row.
  void start(const Kkt&, const VecX& f, const VecX& c);
  /// Residuals of (a, lambda); true when both are small enough.
  bool met(const Kkt&, const VecX& f, const VecX& c, const VecX& a, const VecX& lambda);

  /// The proximal iteration from a = 0, lambda = 0: `add(a, lambda)` adds the factor's answer to force_residual() and
  /// row_residual(), once and then as long as the rule is not met. Fills residual, worst_row and corrections.
  template <class Add>
  void iterate(const Kkt& kkt, const VecX& f, const VecX& c, VecX& a, VecX& lambda, SolveReport& report, Add&& add) {
    a.setZero(kkt.pattern.n);
    lambda.setZero(kkt.pattern.m);
    start(kkt, f, c);
    bool done = met(kkt, f, c, a, lambda);
    for (int round = 0; round == 0 || (!done && round <= kMaxCorrections); ++round) {
      add(a, lambda);
      report.corrections = round;
      done = met(kkt, f, c, a, lambda);
    }
    report.residual = largest_;
    report.worst_row = worst_row_;
  }

  const VecX& force_residual() const { return r_f_; }  ///< f - M a - J^T lambda
  const VecX& row_residual() const { return r_c_; }    ///< c - J a
  double largest() const { return largest_; }          ///< |c - J a| against its scale, the largest; NaN if one is
  int worst_row() const { return worst_row_; }
  /// At the same place as before the last correction, or nearly.
  bool stalled() const { return largest_ > 0.5 * before_; }

 private:
  using Floors = std::array<double, 3>;  // one a RowKind
  bool rows_met(const Kkt&, const VecX& c, const VecX& a);
  Floors size_floors(const Kkt&, const VecX& a) const;
  void find_worst(const KktPattern&, const Floors&);
  bool forces_met(const Kkt&, const VecX& f, const VecX& a, const VecX& lambda);

  VecX r_f_, r_c_, scale_, size_n_;
  double energy_f_ = 0.0;  // largest a_f . M a_f of a slot
  double largest_ = 0.0, before_ = 0.0;
  int worst_row_ = -1;
};

}  // namespace lockstep
