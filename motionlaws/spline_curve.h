// The C2 (cubic) or C4 (quintic) spline through points that 'spline', 'path' and 'spline_rotation' share.
#pragma once

#include <string>
#include <vector>

#include "framework/foundation/math/types.h"
#include "framework/foundation/support/export.h"

namespace lockstep {

enum class SplineEnds {
  natural,   ///< cubic: second derivative 0; quintic: third and fourth derivative 0 at both ends
  clamped,   ///< first (quintic: and second) derivative given at both ends, 0 unless said
  periodic,  ///< last point = first; derivatives meet
};
enum class SplineOutside {
  refuse,  ///< ModelError with the range
  hold,    ///< the value of the nearer end, at rest
  repeat,  ///< for periodic ends only: over and over
};

struct SplineSettings {
  int degree = 3;  ///< 3 or 5
  SplineEnds ends = SplineEnds::natural;
  SplineOutside outside = SplineOutside::refuse;
};

/// Derivatives at clamped ends, one component each; an empty one is 0.
struct SplineEndRates {
  VecX start_rate{}, end_rate{};                  ///< first derivative
  VecX start_acceleration{}, end_acceleration{};  ///< second derivative, quintic only
};

/// A curve of `n_components` functions of t through the points (t_i, y_i), i = 0 .. n; one polynomial an interval.
class LOCKSTEP_API SplineCurve {
 public:
  /// `law` names it in messages; t strictly increasing; y one row a point. `turn` = -1 makes the last point and its
  /// rates the negatives of the first ones (quaternions after an odd number of full turns). Throws ModelError
  /// (ParameterError).
  SplineCurve(const char* law, std::vector<double> t, const MatX& y, const SplineSettings&, const SplineEndRates& = {},
              double turn = 1);
  /// y, yd, ydd, n_components each. Throws ModelError outside of the range when that is to be refused.
  void at(double t, double* y, double* yd, double* ydd) const;
  /// Jumps in (t0, t1): the ends of the range when the value is held there and the curve does not come to rest. None
  /// inside.
  void breakpoints(double t0, double t1, std::vector<double>& out) const;
  double first() const { return t_.front(); }
  double last() const { return t_.back(); }
  int n_components() const { return n_components_; }

 private:
  void check(const MatX& y) const;
  void fill(const MatX& y, const MatX& nodes);
  std::size_t interval(double t) const;
  std::string law_;
  std::vector<double> t_;
  SplineSettings k_;
  double turn_;
  int n_components_;
  std::vector<double> c_;  // [interval][component][power], powers 0 .. degree
  bool rest_at_first_ = false, rest_at_last_ = false;
};

/// First (and for the quintic second) derivatives at the points: row i of the result for a cubic, rows 2 i and 2 i + 1
/// for a quintic; one column a component. Tridiagonal by blocks of 1 or 2, with a border when periodic.
MatX spline_nodes(const std::vector<double>& t, const MatX& y, int degree, SplineEnds, const SplineEndRates&,
                  double turn);

}  // namespace lockstep
