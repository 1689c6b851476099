// SPDX-License-Identifier: BSD-3-Clause
// Private to the room: the C2 (cubic) or C4 (quintic) spline through points of the laws 'spline', 'path' and
// 'spline_rotation', and the keys that they share.
#pragma once

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/splines.h>

namespace lockstep {

/// A spline of `n_components` functions of t through the points (t_i, y_i), i = 0 .. n; one polynomial per interval.
class SplineCurve {
 public:
  /// `law` names the type in messages; times strictly increasing. `rates`: first and second derivative at the first point,
  /// then at the last, for clamped ends; the second ones for the quintic only. `turn` = -1: the last point and its rates are the negatives of the first ones (quaternions after an odd number of
  /// full turns). Throws ModelError (ParameterError) for too few points, times that do not increase, numbers that are
  /// not finite, periodic ends that do not meet, or `repeat` without periodic ends.
  SplineCurve(const char* law, const Columns& points, const SplineSettings&, const MatX& rates, double turn = 1);
  /// Writes value, first and second derivative at t, s, one number per component each. Throws ModelError outside of the points
  /// when that is an error.
  void at(double t, double* y, double* yd, double* ydd) const;
  /// Appends the jumps in (t0, t1), s: the ends of the range when the value is held outside and the curve does not come
  /// to rest there. There are none between the points.
  void breakpoints(double t0, double t1, std::vector<double>& out) const;
  /// Whether this combination of its components, one weight each, has one value at all times.
  bool is_constant(const VecX& weights) const;
  double first() const { return t_.front(); }  ///< first time, s
  double last() const { return t_.back(); }    ///< last time, s

 private:
  void check(const MatX& y) const;
  void fill(const MatX& y, const MatX& nodes);
  std::string law_;
  std::vector<double> t_;
  SplineSettings k_;
  double turn_;
  int n_components_;
  std::vector<double> c_;  // [interval][component][power], powers 0 .. degree
  bool rest_at_first_ = false, rest_at_last_ = false;
};

/// First (and for the quintic second) derivatives at the points, one column per component: row i of the result for a
/// cubic, rows 2 i and 2 i + 1 for a quintic. Solves a system of blocks of 1 or 2, tridiagonal, with a border when
/// periodic.
MatX spline_nodes(const Columns& points, int degree, SplineEnds, const MatX& rates, double turn);

// The keys that 'spline', 'path' and 'spline_rotation' share, and how they are read.

/// Rows of numbers as a table: the time, then n_y others.
Columns columns_of(const std::vector<std::vector<double>>& rows, std::size_t n_y);

/// Appends the keys degree, ends and outside.
void add_spline_keys(Keys&);
/// The keys of points, with this help, or of a file; of its columns besides that of the times, each with its default and
/// its contents; then those of add_spline_keys().
Keys spline_keys(const char* points, std::initializer_list<std::pair<const char*, const char*>> columns);
/// Reads the keys of add_spline_keys().
SplineSettings spline_settings(const Params&);

/// Throws SceneError for keys of end rates that would have no effect: any of `first` and `second` without clamped ends,
/// any of `second` (second derivatives) without degree 5.
void check_end_keys(const Params&, const SplineSettings&, std::initializer_list<const char*> first,
                    std::initializer_list<const char*> second);

}  // namespace lockstep
