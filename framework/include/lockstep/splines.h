// SPDX-License-Identifier: BSD-3-Clause
// Laws through points.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <lockstep/author/law.h>
#include <lockstep/author/params.h>

namespace lockstep {

// Columns of a CSV file, for laws through measured or computed points.

/// A column of times and other columns of a file, one row per line.
struct Columns {
  std::vector<double> t;  ///< times, s
  MatX y;                 ///< one row per time, one column per column that was asked for
};

/// Reads `t_column` and `y_columns` of the file at `path`. A column is named by the header's word before any "[unit]",
/// or by its number from 1; its numbers are converted from that unit to SI. The first line decides the separator:
/// semicolon, tab or else comma; unless it is the comma, numbers may have decimal commas. Cells may be in
/// double quotes; blank lines and lines that start with # are skipped; a file whose first line holds only numbers has no
/// header. Independent of the locale. Throws FileError with file and line: no such file, no such column, two of its
/// name, an unknown unit, no rows, a row of more or fewer cells than the first line, a cell that is not a finite
/// number, a first line of words and numbers, times that do not increase.
LOCKSTEP_API Columns read_columns(const std::string& path, const std::string& t_column,
                                  const std::vector<std::string>& y_columns);

/// The points of a law from its key "points" (rows [t, y...]) or from its key "file" with the columns `t_column` and
/// `y_columns`; a relative path starts at the scene's folder. Throws SceneError unless exactly one of the two is given
/// and rows have 1 + n_components numbers, and what read_columns() throws.
LOCKSTEP_API Columns points_of(const Params&, std::size_t n_components, const std::string& t_column,
                               const std::vector<std::string>& y_columns);

// The C2 (cubic) or C4 (quintic) spline through points of the laws 'spline', 'path' and 'spline_rotation'.

/// The conditions at the ends of a spline.
enum class SplineEnds {
  natural,   ///< cubic: second derivative 0; quintic: third and fourth derivative 0 at both ends
  clamped,   ///< first (quintic: and second) derivative given at both ends, 0 by default
  periodic,  ///< the last point is the first; all derivatives that are continuous inside are continuous there too
};
/// The value of a spline outside of its points.
enum class SplineOutside {
  refuse,  ///< throws ModelError with the range
  hold,    ///< the value of the nearer end, at rest
  repeat,  ///< repeats the points; for periodic ends only
};

/// Degree of a spline, the conditions at its ends, and its value outside of them.
struct SplineSettings {
  int degree = 3;                                 ///< 3 or 5
  SplineEnds ends = SplineEnds::natural;          ///< conditions at both ends
  SplineOutside outside = SplineOutside::refuse;  ///< value before the first and after the last point
};

/// Times, s, and positions, m.
using PathPoints = std::vector<std::pair<double, Vec3>>;

/// Velocities and accelerations at clamped ends; the latter for the quintic only.
struct PathEndValues {
  Vec3 start_velocity = Vec3::Zero(),      ///< m/s
      end_velocity = Vec3::Zero();         ///< m/s
  Vec3 start_acceleration = Vec3::Zero(),  ///< m/s^2
      end_acceleration = Vec3::Zero();     ///< m/s^2
};

/// Times, s, and values.
using SplinePoints = std::vector<std::pair<double, double>>;

/// Rates at clamped ends; second derivatives for the quintic only.
struct SplineEndValues {
  double start_rate = 0,       ///< unit of y per s
      end_rate = 0,            ///< unit of y per s
      start_acceleration = 0,  ///< unit of y per s^2
      end_acceleration = 0;    ///< unit of y per s^2
};

/// Times, s, and orientations of any length but zero: frame's axes -> axes of the frame in which it is imposed.
using RotationPoints = std::vector<std::pair<double, Quat>>;

namespace laws {
// Translation law 'path'.

/// A spline x(t), m, through the points (t_i, x_i), times in s, in the axes of the frame in which it is imposed. Ends,
/// breakpoints and exceptions as those of spline().
LOCKSTEP_API LawPtr<TranslationLaw> path(const PathPoints& points, const SplineSettings& k = {},
                                         const PathEndValues& ends = {});

// Law 'spline'.

/// A spline y(t) through the points (t_i, y_i): cubic with continuous ydd, or quintic with continuous yddd and ydddd.
/// Outside of the points: a ModelError, held, or repeated (periodic ends). Breakpoints: the ends of the range,
/// if the value is held there and the curve does not come to rest. t in s, y in the unit of the coordinate. Throws
/// ModelError for too few points, times that do not increase, numbers that are not finite, periodic ends that do not
/// meet, `repeat` without periodic ends.
LOCKSTEP_API LawPtr<MotionLaw> spline(const SplinePoints& points, const SplineSettings& k = {},
                                      const SplineEndValues& ends = {});

// Rotation law 'spline_rotation'.

/// The rotation q(t) = r(t)/|r(t)| through the orientations (t_i, q_i), r(t) a cubic or quintic spline of the four
/// components.
///
/// q and -q are one orientation, so the sign of each q_i is first chosen such that q_i . q_(i-1) > 0. Then r is C2 (C4)
/// and passes through the q_i, and |r| stays far from zero, hence q is C2 (C4) too; w and a, computed on jets through
/// r/|r|, are exact and continuous. Unlike splines of rotation vectors or angles, it has no singularity at half or full
/// revolutions made in several pieces. Multiplying all q_i by one rotation, from the left or from the right, multiplies
/// the motion by it. Unlike C2 splines on the group, which are implicit (interpolating) or miss their points
/// (B-splines), it takes a linear system and a division. The price: the speed is uneven between points that are far
/// apart; keep neighbours within about 90 degrees. Neighbours 180 degrees apart are an error.
///
/// Ends: natural; clamped = at rest (quintic: without angular acceleration too); periodic: last orientation equal to
/// the first. Throws ModelError for too few points, times that do not increase, quaternions that are zero or not finite,
/// neighbours 180 degrees apart, periodic ends that do not meet, |r| below 1/2 between points.
LOCKSTEP_API LawPtr<RotationLaw> spline_rotation(const RotationPoints& points, const SplineSettings& k = {});
}  // namespace laws

}  // namespace lockstep
