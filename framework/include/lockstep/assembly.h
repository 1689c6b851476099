// Assembly: brings a start onto the constraints, positions first, then velocities.
#pragma once

#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/kernel.h>

namespace lockstep {

/// A velocity that the start shall have on a link's coordinate: P against S, along or about an axis of S, m/s or rad/s.
struct VelocityTarget {
  std::string link;
  Axis axis = Axis::rz;
  double value = 0;
};

/// What assembling a start changed.
struct AssemblyReport {
  double before = 0, after = 0;      ///< |C|, m
  double before_v = 0, after_v = 0;  ///< |Jh v + Ct|, m/s
  int iterations = 0;
  double largest_move = 0;              ///< m
  double largest_turn = 0;              ///< rad
  std::string moved_most, turned_most;  ///< bodies

  bool is_notable() const;   ///< by more than 1e-6 m, rad or m/s
  std::string text() const;  ///< one sentence
};

/// When assembling ends.
struct AssemblyOptions {
  double tolerance = 1e-12;  ///< of |C|, m (not below the round-off of the largest position)
  int iterations = 60;
};

/// Newton with the Cayley update (8.2), least mass-weighted move; a step that does not lessen |C| is halved. Then the
/// least mass-weighted change of the velocities onto Jh v = -Ct and the targets. Throws AssemblyError with the worst
/// rows by name; the state is left as it was then. A notable correction is logged (support/log.h, level info).
LOCKSTEP_API AssemblyReport assemble(Dynamics&, State&, const std::vector<VelocityTarget>& targets = {},
                                     const AssemblyOptions& options = {});

}  // namespace lockstep
