// SPDX-License-Identifier: BSD-3-Clause
// Laws through points.
#pragma once

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/author/params.h>
#include <lockstep/math.h>

namespace lockstep {

// Columns of a CSV file, for laws through measured or computed points.

/// A column of times and other columns of a file, one row per line.
struct Columns {
  std::vector<double> t;  ///< times, s
  MatX y;                 ///< one row per time, one column per column that was asked for
};

/// Reads `t_column` and `y_columns` of the file at `path`. A column is named by the header's word before any "[unit]",
/// or by its number from 1; its numbers are converted from that unit to SI. The first line says how cells are separated:
/// by semicolons, tabs or else commas; where these are not commas, numbers may have decimal ones. Cells may stand in
/// double quotes; blank lines and lines that start with # are skipped; a file whose first line holds only numbers has no
/// header. Independent of the locale. Throws FileError with file and line: no such file, no such column, two of its
/// name, a unit that is none, no rows, a row of more or fewer cells than the first line, a cell that is not a finite
/// number, a first line of words and numbers, times that do not increase.
LOCKSTEP_API Columns read_columns(const std::string& path, const std::string& t_column,
                                  const std::vector<std::string>& y_columns);

// The C2 (cubic) or C4 (quintic) spline through points of the laws 'spline', 'path' and 'spline_rotation'.

/// What holds at the ends of a spline.
enum class SplineEnds {
  natural,   ///< cubic: second derivative 0; quintic: third and fourth derivative 0 at both ends
  clamped,   ///< first (quintic: and second) derivative given at both ends, 0 by default
  periodic,  ///< the last point is the first; all derivatives that are continuous inside are continuous there too
};
/// What a spline does outside of its points.
enum class SplineOutside {
  refuse,  ///< throws ModelError with the range
  hold,    ///< the value of the nearer end, at rest
  repeat,  ///< repeats the points; for periodic ends only
};

/// Degree of a spline, what holds at its ends, and what it does outside of them.
struct SplineSettings {
  int degree = 3;                                 ///< 3 or 5
  SplineEnds ends = SplineEnds::natural;          ///< what holds at both ends
  SplineOutside outside = SplineOutside::refuse;  ///< what holds before the first and after the last point
};

/// Derivatives at clamped ends, one per component; an empty one is 0.
struct SplineEndRates {
  VecX start_rate{},          ///< first derivative at the first point
      end_rate{};             ///< first derivative at the last point
  VecX start_acceleration{},  ///< second derivative at the first point; quintic only
      end_acceleration{};     ///< second derivative at the last point; quintic only
};

/// A spline of `n_components` functions of t through the points (t_i, y_i), i = 0 .. n; one polynomial per interval.
class LOCKSTEP_API SplineCurve {
 public:
  /// `law` names the type in messages; t strictly increasing, s; y has one row per point, one column per component.
  /// `turn` = -1: the last point and its rates are the negatives of the first ones (quaternions after an odd number of
  /// full turns). Throws ModelError (ParameterError) for too few points, times that do not increase, numbers that are
  /// not finite, periodic ends that do not meet, or `repeat` without periodic ends.
  SplineCurve(const char* law, std::vector<double> t, const MatX& y, const SplineSettings&, const SplineEndRates& = {},
              double turn = 1);
  /// Writes value, first and second derivative at t, s, n_components() each. Throws ModelError outside of the points
  /// when that is refused.
  void at(double t, double* y, double* yd, double* ydd) const;
  /// Appends the jumps in (t0, t1), s: the ends of the range when the value is held outside and the curve does not come
  /// to rest there. There are none between the points.
  void breakpoints(double t0, double t1, std::vector<double>& out) const;
  /// Whether this combination of its components, one weight each, has one value at all times.
  bool is_constant(const VecX& weights) const;
  double first() const { return t_.front(); }         ///< first time, s
  double last() const { return t_.back(); }           ///< last time, s
  int n_components() const { return n_components_; }  ///< number of components

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

/// First (and for the quintic second) derivatives at the points, one column per component: row i of the result for a
/// cubic, rows 2 i and 2 i + 1 for a quintic. Solves a system of blocks of 1 or 2, tridiagonal, with a border when
/// periodic.
LOCKSTEP_API MatX spline_nodes(const std::vector<double>& t, const MatX& y, int degree, SplineEnds,
                               const SplineEndRates&, double turn);

// Translation law 'path'.

/// Velocities and accelerations at clamped ends; the latter for the quintic only.
struct PathEndValues {
  Vec3 start_velocity = Vec3::Zero(),      ///< m/s
      end_velocity = Vec3::Zero();         ///< m/s
  Vec3 start_acceleration = Vec3::Zero(),  ///< m/s^2
      end_acceleration = Vec3::Zero();     ///< m/s^2
};

/// A spline x(t), m, through the points (t_i, x_i), times in s, in the axes of the frame in which it is imposed. See
/// Spline.
class LOCKSTEP_API PathLaw final : public TranslationLaw {
 public:
  using Points = std::vector<std::pair<double, Vec3>>;  ///< times, s, and positions, m
  /// Throws ModelError for too few points, times that do not increase, numbers that are not finite, periodic ends that
  /// do not meet.
  explicit PathLaw(const Points& points, const SplineSettings& = {}, const PathEndValues& = {});
  /// From a curve of three components.
  explicit PathLaw(SplineCurve curve) : curve_(std::move(curve)) {}
  TranslationValue at(double t) const override;
  bool stays_in_plane(const Vec3& normal) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                      ///< name and keys of its type
  static LawPtr<TranslationLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  SplineCurve curve_;
};

namespace laws {
/// A PathLaw.
LOCKSTEP_API LawPtr<TranslationLaw> path(const PathLaw::Points& points, const SplineSettings& k = {},
                                         const PathEndValues& ends = {});
}  // namespace laws

// Law 'spline'.

/// Rates at clamped ends; second derivatives for the quintic only.
struct SplineEndValues {
  double start_rate = 0,       ///< unit of y per s
      end_rate = 0,            ///< unit of y per s
      start_acceleration = 0,  ///< unit of y per s^2
      end_acceleration = 0;    ///< unit of y per s^2
};

/// A spline y(t) through the points (t_i, y_i): cubic with continuous ydd, or quintic with continuous yddd and ydddd.
/// Outside of the points: refused by ModelError, held, or repeated (periodic ends). t in s, y in the unit of the
/// coordinate.
class LOCKSTEP_API Spline final : public MotionLaw {
 public:
  using Points = std::vector<std::pair<double, double>>;  ///< times, s, and values
  /// Throws ModelError for too few points, times that do not increase, numbers that are not finite, periodic ends that
  /// do not meet.
  explicit Spline(const Points& points, const SplineSettings& = {}, const SplineEndValues& = {});
  /// From a curve of one component.
  explicit Spline(SplineCurve curve) : curve_(std::move(curve)) {}
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  SplineCurve curve_;
};

namespace laws {
/// A Spline.
LOCKSTEP_API LawPtr<MotionLaw> spline(const Spline::Points& points, const SplineSettings& k = {},
                                      const SplineEndValues& ends = {});
}  // namespace laws

// The keys that 'spline', 'path' and 'spline_rotation' share, and how they are read.

/// Appends the keys degree, ends and outside.
LOCKSTEP_API void add_spline_keys(Keys&);
/// Reads the keys of add_spline_keys().
LOCKSTEP_API SplineSettings spline_settings(const Params&);

/// Throws SceneError for keys of end rates that would have no effect: any of `first` and `second` without clamped ends,
/// any of `second` (second derivatives) without degree 5.
LOCKSTEP_API void check_end_keys(const Params&, const SplineSettings&, std::initializer_list<const char*> first,
                                 std::initializer_list<const char*> second);

/// The points of a law from its key "points" (rows [t, y...]) or from its key "file" with the columns `t_column` and
/// `y_columns`; a relative path starts at the scene's folder. Throws SceneError unless exactly one of the two is given
/// and rows have 1 + n_components numbers, and what read_columns() throws.
LOCKSTEP_API Columns points_of(const Params&, std::size_t n_components, const std::string& t_column,
                               const std::vector<std::string>& y_columns);

// Rotation law 'spline_rotation'.

/// The rotation q(t) = r(t)/|r(t)| through the orientations (t_i, q_i), r(t) a cubic or quintic spline of the four
/// components.
///
/// q and -q are one orientation, so the sign of each q_i is first chosen such that q_i . q_(i-1) > 0. Then r is C2 (C4)
/// and passes through the q_i, and |r| stays far from zero, hence q is C2 (C4) too; w and a, computed on jets through
/// r/|r|, are exact and continuous. Unlike splines of rotation vectors or angles, it has no singularity at half or full
/// turns made in several pieces, and turning all q_i by one rotation, from the left or from the right, turns the motion
/// by it. Unlike C2 splines on the group, which are implicit (interpolating) or miss their points (B-splines), it takes
/// a linear system and a division. The price: the speed is uneven between points that are far apart; keep neighbours
/// within about 90 degrees. Neighbours half a turn apart are refused, because the way round is not defined.
///
/// Ends: natural; clamped = at rest (quintic: without angular acceleration too); periodic: last orientation equal to
/// the first.
class LOCKSTEP_API SplineRotation final : public RotationLaw {
 public:
  /// Times, s, and orientations: frame's axes -> axes of the frame in which it is imposed.
  using Points = std::vector<std::pair<double, Quat>>;
  /// Orientations of any length but zero. Throws ModelError for too few points, times that do not increase, quaternions
  /// that are zero or not finite, neighbours half a turn apart, periodic ends that do not meet, |r| below 1/2 between
  /// points.
  explicit SplineRotation(const Points& points, const SplineSettings& = {});
  RotationValue at(double t) const override;
  bool turns_about(const Vec3& axis) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                   ///< name and keys of its type
  static LawPtr<RotationLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  SplineCurve curve_;
};

namespace laws {
/// A SplineRotation.
LOCKSTEP_API LawPtr<RotationLaw> spline_rotation(const SplineRotation::Points& points, const SplineSettings& k = {});
}  // namespace laws

}  // namespace lockstep
