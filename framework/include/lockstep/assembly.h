// SPDX-License-Identifier: BSD-3-Clause
// Assembly: brings a start onto the constraints, positions first, then velocities.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <lockstep/author/mask.h>
#include <lockstep/finding.h>

namespace lockstep {

class Dynamics;
struct State;

/// A start velocity of a coordinate of a joint: of P relative to S, along or about an axis of S.
struct VelocityTarget {
  std::string link;      ///< name of the joint
  Axis axis = Axis::rz;  ///< the coordinate
  double value = 0;      ///< m/s or rad/s
};

/// A start value of a coordinate of a joint: of P relative to S, along or about an axis of S; an angle is the rotation
/// of P about that axis alone.
struct CoordinateTarget {
  std::string link;      ///< name of the joint
  Axis axis = Axis::rz;  ///< the coordinate
  double value = 0;      ///< m or rad
  /// Its weight against other targets and the start poses, rotations times System::length(); infinite: it is exact.
  double weight = std::numeric_limits<double>::infinity();
};

/// Weight of the start pose of a body in assembly.
struct PoseWeight {
  std::string body;   ///< its name
  double weight = 1;  ///< against those of others, 1 each; infinite: it does not move; 0: it is free
};

/// A start velocity of a body that is stated, not merely the default of zero.
struct StatedVelocity {
  std::string body;       ///< its name
  bool velocity = false,  ///< whether that of its frame's origin is,
      omega = false,      ///< and its angular velocity,
      in_world = false;   ///< in world axes
};

/// A joint that start poses violate.
struct OpenJoint {
  std::string joint;  ///< its name
  double gap = 0;     ///< |C| over its constraints without drives, m, rotations as lengths
};

/// Changes of a start by assembly.
struct AssemblyReport {
  /// Constraint violation of the given start, m: the largest |C|, or |C| / |grad C| of a function with a smaller
  /// gradient.
  double before = 0;
  double after = 0;               ///< the same of the assembled start, m
  double before_v = 0,            ///< |Jh v + Ct| at the assembled position with the given velocities, m/s
      after_v = 0;                ///< |Jh v + Ct| of the assembled start, m/s
  std::vector<OpenJoint> open{};  ///< joints that the given poses violate by more than 1e-6 m
  int iterations = 0;             ///< of the positions
  double largest_move = 0;        ///< of a body, m
  double largest_turn = 0;        ///< rotation of a body, rad
  std::string moved_most,         ///< the body with the largest move; "" if none moved
      turned_most;                ///< the body with the largest rotation; "" if none rotated
  double kinetic_before = 0,      ///< kinetic energy with the given velocities, at the assembled position, J
      kinetic_after = 0;          ///< kinetic energy of the assembled start, J
  /// Changes that are hardly intended: a body moved by more than a thousandth of the length, a stated velocity changed,
  /// much of the energy lost; with the bodies without a start velocity.
  std::vector<Finding> findings{};

  LOCKSTEP_API bool is_moved() const;     ///< whether a body moved by more than 1e-6 m or rad
  LOCKSTEP_API bool is_notable() const;   ///< whether a violation or a change was more than 1e-6 m, rad or m/s
  LOCKSTEP_API std::string text() const;  ///< the report in one sentence
};

/// Limits and targets of assembly.
struct AssemblyOptions {
  double tolerance = 1e-12;  ///< of |C|, m (not below the round-off of the largest position)
  int iterations = 60;       ///< of the positions, at most, for each share of a way
  /// With these or weights, the assembled start minimises the weighted sum of squared distances from the requested
  /// values (solved densely, up to 250 bodies).
  std::vector<CoordinateTarget> coordinates{};
  std::vector<PoseWeight> poses{};       ///< of the bodies whose weight is not 1
  std::vector<StatedVelocity> stated{};  ///< a change of more than 1e-9 (relative above 1) is reported
};

/// Brings a state onto the constraints. Positions: Newton's method with the Cayley update (8.2) and the least
/// mass-weighted move; a step that does not reduce |C| is halved. If that fails, drives are led from the given poses to
/// their start values, in shares that rotate no body by more than an eighth of a revolution; so are requested
/// coordinates. Velocities: the least mass-weighted change onto Jh v = -Ct and the targets, which are met to round-off.
/// Counted angles (CountedAngle) follow that way and begin in the revolution that coordinates or drives request, if
/// they are as System::start() leaves them. A notable correction is logged (log.h, level info), the report's findings
/// go to report_finding(). Throws AssemblyError with the names of the worst rows; ModelError for a target of an unknown
/// joint or body, or of a joint without markers, for a weight below zero, a value that is not finite, and for weights
/// or coordinates of more than 250 bodies; and what an evaluation throws. The state is then unchanged.
LOCKSTEP_API AssemblyReport assemble(Dynamics&, State&, const std::vector<VelocityTarget>& targets = {},
                                     const AssemblyOptions& options = {});

}  // namespace lockstep
