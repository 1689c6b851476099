// Laws through points.
#pragma once

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/export.h>
#include <lockstep/math.h>
#include <lockstep/params.h>

namespace lockstep {

// Columns of a CSV file, for the laws that go through measured or computed points.


/// The column of times and the asked columns, one row a line of the file.
struct Columns {
  std::vector<double> t;
  MatX y;
};

/// Reads `t_column` and `y_columns` of the file at `path`. A column is named by the header's word before any "[unit]",
/// or by its number from 1. Cells are separated by commas or semicolons; blank lines and lines that start with # are
/// skipped; a file whose first line holds numbers only has no header. Numbers are SI with a point, whatever the locale.
/// Throws FileError naming file and line: no such file, no such column, a cell that is no finite number, times that do
/// not rise.
LOCKSTEP_API Columns read_columns(const std::string& path, const std::string& t_column,
                                  const std::vector<std::string>& y_columns);


// The C2 (cubic) or C4 (quintic) spline through points that 'spline', 'path' and 'spline_rotation' share.


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

/// Degree of a spline, what holds at its ends and what outside of them.
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


// Translation law 'path'.


/// Rates at clamped ends, m/s and m/s^2 (the latter for the quintic only).
struct PathEndValues {
  Vec3 start_velocity = Vec3::Zero(), end_velocity = Vec3::Zero();
  Vec3 start_acceleration = Vec3::Zero(), end_acceleration = Vec3::Zero();
};

/// x(t), m: a cubic or quintic spline for each component through the points (t_i, x_i), times in s. See Spline.
class LOCKSTEP_API PathLaw final : public TranslationLaw {
 public:
  using Points = std::vector<std::pair<double, Vec3>>;
  /// Throws ModelError: too few points, times that do not rise, numbers not finite, periodic ends that do not meet.
  explicit PathLaw(const Points& points, const SplineSettings& = {}, const PathEndValues& = {});
  explicit PathLaw(SplineCurve curve) : curve_(std::move(curve)) {}
  TranslationValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<TranslationLaw> make(const Params&);

 private:
  SplineCurve curve_;
};

namespace laws {
inline LawPtr<TranslationLaw> path(const PathLaw::Points& points, const SplineSettings& k = {},
                                   const PathEndValues& ends = {}) {
  return std::make_shared<const PathLaw>(points, k, ends);
}
}  // namespace laws


// Law 'spline'.


/// Rates at clamped ends, the unit of y per s and per s^2 (the latter for the quintic only).
struct SplineEndValues {
  double start_rate = 0, end_rate = 0, start_acceleration = 0, end_acceleration = 0;
};

/// Piecewise polynomial y(t) through the points (t_i, y_i): cubic with continuous ydd, or quintic with continuous yddd
/// and ydddd. Outside of the points: refused by ModelError, held, or repeated (periodic ends). t in s, y in the unit of
/// the coordinate.
class LOCKSTEP_API Spline final : public MotionLaw {
 public:
  using Points = std::vector<std::pair<double, double>>;
  /// Throws ModelError: too few points, times that do not rise, numbers not finite, periodic ends that do not meet.
  explicit Spline(const Points& points, const SplineSettings& = {}, const SplineEndValues& = {});
  explicit Spline(SplineCurve curve) : curve_(std::move(curve)) {}
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 private:
  SplineCurve curve_;
};

namespace laws {
inline LawPtr<MotionLaw> spline(const Spline::Points& points, const SplineSettings& k = {},
                                const SplineEndValues& ends = {}) {
  return std::make_shared<const Spline>(points, k, ends);
}
}  // namespace laws


// The keys that 'spline', 'path' and 'spline_rotation' share, and how they are read.


/// Appends degree, ends and outside.
void add_spline_keys(Keys&);
SplineSettings spline_settings(const Params&);

/// Refuses keys of end rates that would have no effect: without clamped ends, second derivatives without degree 5.
void check_end_keys(const Params&, const SplineSettings&, std::initializer_list<const char*> first,
                    std::initializer_list<const char*> second);

/// The points of a law with the keys "points" (rows [t, y...]) or "file" with `t_column` and `y_columns`: exactly one
/// of both.
Columns points_of(const Params&, std::size_t n_components, const std::string& t_column,
                  const std::vector<std::string>& y_columns);


// Rotation law 'spline_rotation'.


/// q(t) = r(t)/|r(t)| through the orientations (t_i, q_i), r(t) a cubic or quintic spline of the four components.
///
/// Why this and not another: q and -q are one orientation, so the sign of each q_i is first made that of its
/// predecessor (q_i . q_(i-1) > 0); then r is C2 (C4) and passes through the q_i, and |r| stays far from zero, hence q
/// is C2 (C4) too, and w and a, exact by jets through r/|r|, are continuous. Full turns and half turns in the sum of
/// several pieces are nothing special, unlike for splines of rotation vectors or angles; turning all q_i by one
/// rotation, from the left or from the right, turns the motion by it; and the method is a linear system and a division,
/// unlike splines built on the group, whose C2 form is implicit (interpolating) or misses its points (B-splines). Its
/// price: between points far apart the speed is not even; keep neighbours within about 90 degrees. Neighbours half a
/// turn apart are refused, for the way round is not defined.
///
/// Ends: natural; clamped = at rest (quintic: without angular acceleration too); periodic: last orientation equal to
/// the first.
class LOCKSTEP_API SplineRotation final : public RotationLaw {
 public:
  using Points = std::vector<std::pair<double, Quat>>;
  /// Orientations of any length but zero. Throws ModelError: too few points, times that do not rise, zero or not finite
  /// quaternions, neighbours half a turn apart, periodic ends that do not meet, r too near to zero between points.
  explicit SplineRotation(const Points& points, const SplineSettings& = {});
  RotationValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<RotationLaw> make(const Params&);

 private:
  SplineCurve curve_;
};

inline LawPtr<RotationLaw> spline_rotation(const SplineRotation::Points& points, const SplineSettings& k = {}) {
  return std::make_shared<const SplineRotation>(points, k);
}

}  // namespace lockstep
