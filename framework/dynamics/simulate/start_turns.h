// Where the counts of turns begin. Internal to assembly.
#pragma once

#include <string>
#include <vector>

#include <lockstep/assembly.h>

namespace lockstep {

/// An angle is known up to full turns; a start may ask for more than half of one, by a coordinate (AssemblyOptions) or by
/// the law of a drive at the state's time t:
///
///     theta = theta_0 + way,   theta_0 in (-pi, pi] of the poses that the bodies are given
///
/// Leads the counted angles along these ways, from the given poses on, so that they begin in the turn that is asked for: P,
/// or S where P is held, turns about the axis of S with all that it carries, or alone where it is part of a loop. Writes
/// them to State::s, and only where they are as System::start() left them. Returns whether it did. `warnings`: of an angle of
/// more than half a turn that it does not lead to, by name: about an axis beside which P turns freely, of more than 10000
/// turns, or that others turn away.
LOCKSTEP_API bool begin_turns(Dynamics&, State&, const AssemblyOptions&, std::vector<std::string>& warnings);

/// The same for a start that is not assembled, by the drives alone; logs the warnings.
LOCKSTEP_API void begin_turns(Dynamics&, State&);

/// The same where nothing is led: counted angles of a state that is as System::start() left them begin within half a turn of
/// zero, but those on which rows depend; others go on.
void count_from(Dynamics&, State&);

/// Takes the branches of all counted angles nearest to those before, at this state.
void follow_turns(Dynamics&, State&);

/// The share of a step of 6 numbers a slot that turns no body by more than an eighth of a turn, so that the angles between
/// two of them can be followed. `length`: of what stands for a turn of 1 rad.
double short_share(int n_slots, const VecX& d, double length = 1);

/// Whether all counted angles are as System::start() left them.
bool turns_begin(const System&, const State&);

/// Has counted angles on which no rows depend begin within half a turn of zero, unless they were led beyond that, or the
/// iterations from `given` to the state took them there.
void settle_turns(Dynamics&, const State& given, State&);

/// Whether the link holds the turns about the other two axes.
LOCKSTEP_API bool turns_about_one_axis(const Lock&, Axis);

/// Whether rows depend on counted angles.
bool has_coupled_angles(const System&);

/// Whether a link in force is driven by a law of its place or angle.
bool has_drives(const System&, const State&);

/// Turns the bodies of open chains to where drives about axes begin that are more than a quarter turn from there. Returns
/// whether there are such drives, of loops too.
bool turn_to_drives(Dynamics&, State&);

/// The drive about an axis that begins farthest from where the poses are, more than a quarter turn, in words for messages:
/// " (drive rz of link 'A' begins at 180 deg, 180 deg from the poses given)"; "" for none.
std::string farthest_drive(Dynamics&, const State&);

}  // namespace lockstep
