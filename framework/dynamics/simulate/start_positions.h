// SPDX-License-Identifier: BSD-3-Clause
// The positions of a start: targets move from the poses given to what is asked. Internal to assembly.
#pragma once

#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/dynamics.h>

namespace lockstep {

/// A start as it is given, measured with all rows: what assembly changes is reported against it.
struct DrawnStart {
  State state;
  double before;                ///< AssemblyReport::before
  std::vector<OpenJoint> open;  ///< AssemblyReport::open
};
LOCKSTEP_API DrawnStart drawn_start(Dynamics&, const State& given);

/// assemble() of a state that may have been moved, or lost rows, since it was given.
LOCKSTEP_API AssemblyReport assemble_drawn(Dynamics&, State&, const std::vector<VelocityTarget>&,
                                           const AssemblyOptions&, DrawnStart);

/// Moves the positions of a state onto the links, and to what is asked (AssemblyOptions, drives):
///
///     links(x) = 0,  exact: c_i(x) = led_i,   led from the value of the poses given to what is asked
///     least: sum over bodies of w (|dx|^2 + L^2 |turn|^2) + sum over coordinates of w (c - asked)^2
///
/// One Gauss-Newton with one line search. Without weights and coordinates it is the least mass-weighted move onto all
/// rows, and drives are led only if that fails or if rows count revolutions. Counted angles follow the way. `report`:
/// takes iterations, how far off it is, and warnings. Throws AssemblyError with the rows or targets that are not met,
/// ModelError for a target without a meaning.
LOCKSTEP_API void find_positions(Dynamics&, State&, const AssemblyOptions&, AssemblyReport& report);

/// Newton's method onto all rows, from anywhere, to this many m. Returns whether it got there. Throws SolveError and
/// NonFiniteError of rows on the way. The state is in the slots' own coordinates.
LOCKSTEP_API bool approach_links(Dynamics&, State&, double goal);

/// Of a start that is not assembled: counted angles begin in the revolution that the laws of drives ask for. Logs what
/// has none.
LOCKSTEP_API void begin_turns(Dynamics&, State&);

/// Takes the branches of all counted angles nearest to those before. In a state that is as System::start() left them,
/// those on which no rows depend begin within half a revolution of zero.
void count_from(Dynamics&, State&);

}  // namespace lockstep
