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

/// A velocity that the start is to have on a coordinate of a link: of P relative to S, along or about an axis of S.
struct VelocityTarget {
  std::string link;      ///< name of the link
  Axis axis = Axis::rz;  ///< the coordinate
  double value = 0;      ///< m/s or rad/s
};

/// A value that a coordinate of a link is to have at the start: of P relative to S, along or about an axis of S; of an
/// angle, the one that P turns about that axis alone.
struct CoordinateTarget {
  std::string link;      ///< name of the link
  Axis axis = Axis::rz;  ///< the coordinate
  double value = 0;      ///< m or rad
  /// How much it counts against other targets and the start poses, turns times System::length(); infinite: it is exact.
  double weight = std::numeric_limits<double>::infinity();
};

/// How much the start pose of a body counts when a start is assembled.
struct PoseWeight {
  std::string body;   ///< its name
  double weight = 1;  ///< against the weights of others, 1 each; infinite: it stays where it is, 0: it may go anywhere
};

/// What assembling a start changed.
struct AssemblyReport {
  /// How far the start as given is from its constraints, m: the largest |C|, or |C| / |grad C| of a function with a
  /// smaller gradient.
  double before = 0;
  double after = 0;         ///< the same of the assembled start, m
  double before_v = 0,      ///< |Jh v + Ct| at the assembled position with the velocities as given, m/s
      after_v = 0;          ///< |Jh v + Ct| of the assembled start, m/s
  int iterations = 0;       ///< of the positions
  double largest_move = 0;  ///< of a body, m
  double largest_turn = 0;  ///< of a body, rad
  std::string moved_most,   ///< the body with the largest move; "" where none moved
      turned_most;          ///< the body with the largest turn; "" where none turned
  double kinetic_before = 0,  ///< kinetic energy with the velocities as given, at the assembled position, J
      kinetic_after = 0;      ///< kinetic energy of the assembled start, J
  /// What the start hardly meant: a body far from where it was put, most of the energy gone; with the bodies of which no
  /// start velocity is given.
  std::vector<Finding> findings{};

  LOCKSTEP_API bool is_notable() const;   ///< whether a violation or a change was more than 1e-6 m, rad or m/s
  LOCKSTEP_API std::string text() const;  ///< all of it in one sentence
};

/// When assembling ends.
struct AssemblyOptions {
  double tolerance = 1e-12;  ///< of |C|, m (not below the round-off of the largest position)
  int iterations = 60;       ///< of the positions, at most; each share of a way has as many
  /// With these or weights, the assembled start is the one for which the sum of weights times squared distances from what
  /// is asked is least (solved densely, up to 250 bodies).
  std::vector<CoordinateTarget> coordinates{};
  std::vector<PoseWeight> poses{};  ///< of the bodies whose weight is not 1
};

/// Brings a state onto the constraints. Positions: Newton's method with the Cayley update (8.2) and the least
/// mass-weighted move; a step that does not reduce |C| is halved. If that fails, drives are led from the poses given to
/// where they begin, in shares that turn no body by more than an eighth of a turn; so are coordinates that are asked
/// for. Velocities: the least mass-weighted change onto Jh v = -Ct and the targets, which are met to round-off. Counted
/// angles (CountedAngle) follow that way and begin in the turn that coordinates or drives ask for, if they are as
/// System::start() leaves them. A notable correction is logged (log.h, level info), the report's findings go to report_finding().
/// Throws AssemblyError with the names of the worst rows; ModelError for a target of an unknown link or body, or of a
/// link without markers, for a weight below zero, a value that is not finite, and for weights or coordinates of more
/// than 250 bodies; and what an evaluation throws. The state is then unchanged.
LOCKSTEP_API AssemblyReport assemble(Dynamics&, State&, const std::vector<VelocityTarget>& targets = {},
                                     const AssemblyOptions& options = {});

}  // namespace lockstep
