// SPDX-License-Identifier: BSD-3-Clause
// The stopping rule of all solvers: the residuals of a solution, when they are small enough, and when they are a
// contradiction (framework/docs/solvers.md, section 5).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <lockstep/author/solver.h>
#include <lockstep/detail/export.h>
#include "framework/dynamics/solvers/conjugate.h"
#include "framework/dynamics/solvers/products.h"

namespace lockstep {

inline constexpr double kRowTolerance = 1e-12;    ///< relative to the row's scale
inline constexpr double kForceTolerance = 1e-14;  ///< relative to the terms of M a + J^T lambda - f
inline constexpr double kScaleFloor = 1e-3;       ///< relative to the largest scale in the same unit
/// A residual that stalls above this fraction of its scale is a contradiction. States off the constraints, such as the
/// stages of an integrator, leave up to about 1e-3 (a step with a larger violation is rejected) and are not one.
inline constexpr double kContradiction = 1e-2;
/// Off the constraints redundant rows differ by their violations: in this multiple of the violation, relative to the
/// length of the mechanism, what is left over is none of the laws' doing.
inline constexpr double kLeftPerViolation = 200;
inline constexpr int kMaxCorrections = 3;
/// Proximal terms, of the scales of rows: of rows that are eliminated among themselves, and of matrices that are factored
/// as a whole.
inline constexpr double kClosureProximal = 1e-9, kProximalOfMatrix = 1e-8;
/// What kMaxCorrections leave is solved for by conjugate gradients where the last correction left less than this of the
/// residual. A correction leaves E/(S + E): so a direction whose S is not below E is solved for, as in a long lift, and one
/// whose S is smaller is redundant, or would be on the constraints.
inline constexpr double kFalling = 0.5;
inline constexpr double kSmallPivot = 1e-6;     ///< relative; smaller ones count as redundant or singular
inline constexpr double kRedundantPivot = 100;  ///< in proximal terms: pivots of redundant rows are smaller

/// The residual floor of one kind of row: no scale is smaller. `largest`: the largest scale of that kind. Where all
/// scales of a unit vanish (a mechanism driven in other directions only, or held at rest), r is rounding from other
/// units, bounded in any frame by Cauchy and Schwarz:
///   |J_j a| <= sqrt(S_jj) sqrt(a . M a),   and likewise for a_f = M^-1 f,   a = a_f - M^-1 J^T lambda
/// S: the largest S_jj; energy: the largest a . M a + a_f . M a_f of a slot. The tolerance is then 1e-15 of the bound,
/// a few units in the last place. An energy below the least normal number counts as that: it may have vanished.
inline double residual_floor(double largest, double S = 0.0, double energy = 0.0) {
  return kScaleFloor * std::max(largest, std::sqrt(S * std::max(energy, std::numeric_limits<double>::min())));
}

/// Corrects a solution until it meets the rule, with at most kMaxCorrections in total. measure(): residuals of the
/// present solution; within(): whether they are small; raise(): raises the residual floors by energy, false if that
/// cannot help; correct(): the next solution.
template <class Measure, class Within, class Raise, class Correct>
bool refine(int& corrections, Measure&& measure, Within&& within, Raise&& raise, Correct&& correct) {
  const auto met = [&] { return measure(), within() || (raise() && within()); };
  bool done = met();
  for (; !done && corrections < kMaxCorrections; ++corrections) correct(), done = met();
  return done;
}

/// The small pivots of the rows of one matrix. As many as rows are redundant are usual (Kkt::redundant); one more that is small
/// indicates a singular position.
class PivotWatch {
 public:
  void begin(int n_rows) { pivots_.reserve(n_rows + 1); }
  /// `each` calls its argument with the pivot of every row and its diagonal.
  template <class Each>
  void see(int redundant, Each&& each) {
    pivots_.assign(1, std::numeric_limits<double>::infinity());
    each([&](double pivot, double diagonal) { pivots_.push_back(pivot > 0 ? pivot / diagonal : 0.0); });
    std::ranges::sort(pivots_);
    const auto small = std::ranges::lower_bound(pivots_, kSmallPivot) - pivots_.begin();
    smallest_ = pivots_.front();
    regular_ = pivots_[std::min<std::size_t>(redundant < 0 ? small : redundant, pivots_.size() - 1)];
  }
  /// Writes what it saw.
  void report(SolveReport& out) const { out.smallest_pivot = smallest_, out.detector = regular_; }
  /// Whether rows contradict each other: their residual stalled at the order of its scale, and no position is singular,
  /// which may be passed. Contradictory rows are always dependent.
  bool contradictory(double residual, double before) const {
    return residual > kContradiction && residual > kFalling * before && regular_ >= kSmallPivot;
  }

 private:
  std::vector<double> pivots_;  // of the diagonals
  double smallest_ = std::numeric_limits<double>::infinity(), regular_ = smallest_;
};

/// Factors like solver schur, and completes a report by the detector alone: the least eigenvalue of J M^-1 J^T relative to
/// its diagonal but those of Kkt::redundant rows, at least one. Of a matrix with loops.
std::unique_ptr<Factorization> make_detector(const KktPattern&);

/// The rule for a matrix in blocks.
class StopRule {
 public:
  /// Allocates everything. `eps`: proximal term relative to S, of a factor that has one.
  void analyse(const KktPattern&, double eps = 0);
  /// Scales |c| + |J M^-1 f| of the rows, row by row.
  void start(const Kkt&, const VecX& f, const VecX& c);
  /// Residuals of (a, lambda); true when both are small enough.
  bool met(const Kkt&, const VecX& f, const VecX& c, const VecX& a, const VecX& lambda);

  /// The proximal iteration from a = 0, lambda = 0: corrections by `solve`, which writes the factor's answer (da, dl) to
  /// the residuals (r_f, r_c), once and then as long as the rule is not met, by conjugate gradients from the fourth on
  /// where bodies differ much in mass or corrections still help. The pivots in the report are those that the watch saw.
  template <class Solve>
  SolveReport iterate(const Kkt& kkt, const VecX& f, const VecX& c, VecX& a, VecX& lambda, const PivotWatch& watch,
                      Solve&& solve) {
    SolveReport report;
    a.setZero(kkt.pattern.n);
    lambda.setZero(kkt.pattern.m);
    start(kkt, f, c);
    const auto measured = [&] { measure(kkt, f, c, a, lambda); };
    const auto corrected = [&] {
      solve(r_f_, r_c_, da_, dl_);
      a += da_, lambda += dl_;
    };
    measured();
    corrected();
    const bool met = refine(
        report.corrections, measured, [&] { return within(kkt.pattern); }, [&] { return raise_floors(kkt, a); },
        corrected);
    bool rows_met = met;
    if (!met && (differ_in_mass(kkt) || largest_ < kFalling * before_)) {
      const auto step = [&](const VecX& p, double length) {
        lambda += length * p;
        add_reaction_of(kkt, length, p, a);
        measured();
      };
      const auto worst = [&] { return within(kkt.pattern), largest_ / kRowTolerance; };
      rows_met = gradients_.iterate(
          report.corrections, [&](VecX& r) { r = r_c_; }, [&](const VecX& r, VecX& z) { solve(zero_, r, da_, z); },
          step, worst);
      if (rows_met && !forces_met_) corrected(), measured(), within(kkt.pattern);
      before_ = gradients_.refused() ? 0 : HUGE_VAL;  // what is left stays, or was not solved for to the end
    }
    report.residual = largest_;
    report.worst_row = worst_row_;
    report.contradictory = !rows_met && watch.contradictory(largest_, before_);
    watch.report(report);
    return report;
  }

  /// Shows a watch the pivots of the factor; pivot(row).
  template <class Pivot>
  void show_pivots(const Kkt& kkt, PivotWatch& watch, Pivot&& pivot) {
    row_diagonal(kkt, S_);
    const auto each = [&](auto&& row) {
      for (int j = 0; j < kkt.pattern.m; ++j) row(pivot(j), S_[j] + eps_ * kkt.E[j]);
    };
    watch.see(kkt.redundant, each);
  }

  const VecX& force_residual() const { return r_f_; }  ///< f - M a - J^T lambda
  const VecX& row_residual() const { return r_c_; }    ///< c - J a
  double largest() const { return largest_; }          ///< |c - J a| against its scale, the largest; NaN if one is
  int worst_row() const { return worst_row_; }

 private:
  void measure(const Kkt&, const VecX& f, const VecX& c, const VecX& a, const VecX& lambda);
  bool within(const KktPattern&);
  bool raise_floors(const Kkt&, const VecX& a);
  bool differ_in_mass(const Kkt&);
  void add_reaction_of(const Kkt&, double length, const VecX& lambda, VecX& a);
  bool forces_met(const Kkt&, const VecX& f, const VecX& a, const VecX& lambda);

  VecX r_f_, r_c_, scale_, size_n_, S_, da_, dl_, zero_;
  ConjugateGradients gradients_;
  std::array<double, 3> largest_scale_{}, floors_{};  // one per RowKind
  double eps_ = 0.0;
  double energy_f_ = 0.0;  // largest a_f . M a_f of a slot
  double largest_ = 0.0, before_ = 0.0;
  int worst_row_ = -1;
  bool forces_met_ = false;
};

}  // namespace lockstep
