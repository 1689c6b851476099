// The stopping rule of all solvers: the residuals of a solution, when they are small enough, and when they are a
// contradiction (framework/docs/solvers.md, section 5).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <lockstep/solver.h>

namespace lockstep {

inline constexpr double kRowTolerance = 1e-12;    ///< relative to the row's scale
inline constexpr double kForceTolerance = 1e-14;  ///< relative to the terms of M a + J^T lambda - f
inline constexpr double kScaleFloor = 1e-3;       ///< relative to the largest scale in the same unit
/// A residual that stalls above this fraction of its scale is a contradiction. States off the constraints, such as the
/// stages of an integrator, leave up to about 1e-3 (a step with a larger violation is rejected) and are not one.
inline constexpr double kContradiction = 1e-2;
inline constexpr int kMaxCorrections = 3;
inline constexpr double kSmallPivot = 1e-6;  ///< relative; smaller ones count as redundant or singular

/// The residual floor of one kind of row: no scale is smaller. `largest`: the largest scale of that kind. Where all
/// scales of a unit vanish (a mechanism driven in other directions only, or held at rest), r is rounding from other
/// units, bounded in any frame by Cauchy and Schwarz:
///   |J_j a| <= sqrt(S_jj) sqrt(a . M a),   and likewise for a_f = M^-1 f,   a = a_f - M^-1 J^T lambda
/// S: the largest S_jj; energy: the largest a . M a + a_f . M a_f of a slot. The tolerance is then 1e-15 of the bound,
/// a few units in the last place.
inline double residual_floor(double largest, double S = 0.0, double energy = 0.0) {
  return kScaleFloor * std::max(largest, std::sqrt(S * energy));
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

/// Counts small pivots of the rows, relative to their diagonals. Some are usual: rows that are redundant everywhere.
/// More than that indicate a singular position.
class PivotWatch {
 public:
  void begin(int n_rows) { usual_ = n_rows; }
  void count(int n_small) { now_ = n_small, usual_ = std::min(usual_, n_small); }
  /// The smallest pivot beyond the usual ones: falls as the square of the distance to a singular position. Reorders.
  double singularity_indicator(std::vector<double>& pivots) const {
    if (usual_ >= static_cast<int>(pivots.size())) return std::numeric_limits<double>::infinity();
    const auto at = pivots.begin() + usual_;
    std::nth_element(pivots.begin(), at, pivots.end());
    return *at;
  }
  /// Whether rows contradict each other: their residual stalled at the order of its scale. Contradictory rows are
  /// always dependent; small pivots beyond the usual ones indicate a singular position, which may be passed.
  bool contradictory(double residual, double before) const {
    return residual > kContradiction && residual > 0.5 * before && now_ <= usual_;
  }

 private:
  int now_ = 0, usual_ = 0;
};

/// The rule for a matrix in blocks.
class StopRule {
 public:
  void analyse(const KktPattern&);  ///< allocates everything
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
    const auto measured = [&] { measure(kkt, f, c, a, lambda); };
    measured();
    add(a, lambda);
    refine(
        report.corrections, measured, [&] { return within(kkt.pattern); }, [&] { return raise_floors(kkt, a); },
        [&] { add(a, lambda); });
    report.residual = largest_;
    report.worst_row = worst_row_;
  }

  const VecX& force_residual() const { return r_f_; }  ///< f - M a - J^T lambda
  const VecX& row_residual() const { return r_c_; }    ///< c - J a
  double largest() const { return largest_; }          ///< |c - J a| against its scale, the largest; NaN if one is
  double largest_before() const { return before_; }    ///< the same before the last correction
  int worst_row() const { return worst_row_; }

 private:
  void measure(const Kkt&, const VecX& f, const VecX& c, const VecX& a, const VecX& lambda);
  bool within(const KktPattern&);
  bool raise_floors(const Kkt&, const VecX& a);
  bool forces_met(const Kkt&, const VecX& f, const VecX& a, const VecX& lambda);

  VecX r_f_, r_c_, scale_, size_n_, S_;
  std::array<double, 3> largest_scale_{}, floors_{};  // one per RowKind
  double energy_f_ = 0.0;                             // largest a_f . M a_f of a slot
  double largest_ = 0.0, before_ = 0.0;
  int worst_row_ = -1;
  bool forces_met_ = false;
};

}  // namespace lockstep
