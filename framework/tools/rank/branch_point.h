// SPDX-License-Identifier: BSD-3-Clause
// Singular positions by the equations themselves: which motions the rows leave in one position, and along which of them
// a mechanism can leave it.
#pragma once

#include <string>
#include <vector>

#include <lockstep/dynamics.h>

namespace lockstep {

/// What the rows of loops leave free at a state; the rest of the mechanism is left aside. Positions within 1e-5 (rad,
/// or parts of System::length) of a singular one count as in it: nearer than that rounding in the constraints does not
/// tell.
struct LOCKSTEP_API BranchPoint {
  bool known = false;          ///< there are loops, of no more than 300 rows; no law moves them except by drives
  std::vector<bool> slots;     ///< of the system: whether they lie on a loop; empty if nothing is known
  int motions = 0;             ///< motions of these that the rows of the loops leave in this position
  bool singular = false;       ///< some of them the rows stop as soon as they begin
  std::vector<VecX> tangents;  ///< of the branches, 6 per slot: m (world), rad (slot axes); size 1 m
  bool all = false;  ///< the tangents are all there are: two or three motions, and curves that leave along each
  std::vector<std::string> drives,
      joints;  ///< that move in a loop with singular rows, "A.rz"; the joints of these rows
  /// There is one, without a finite motion: per square of a rotation rows are violated by more than 1e-5 of the length.
  bool locked = false;
  double nearness = 1;  ///< in a regular position the smallest singular value of the rows, each of length 1

  /// "2 instantaneous degrees of freedom, 2 branches: 'crank' rotates about z; or ..."; of driven loops, "with A.rz
  /// prescribed, the loop of joints A, B and C may continue in several ways, or not at all". "" in a regular position.
  std::string text(Dynamics&, const State&) const;
  /// Whether something on a loop has a velocity. `v`: 6 per slot; if the position is known.
  bool moves(const VecX& v) const;
  /// The part of the loops' velocity that is not along the nearest branch, 0 to 1.
  double off_branches(const System&, const VecX& v) const;
};

/// To second order: a motion N c of the free ones continues if c . G c = 0 for the form G of each combination of rows
/// that is zero (stopping_form()). The solutions are lines where branches cross. Takes one evaluation, and the factors
/// of the loops' rows (RowSpace).
LOCKSTEP_API BranchPoint branch_point(Dynamics&, const State&);

}  // namespace lockstep
