// Where the counts of turns begin. Internal to assembly and to channels.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <lockstep/assembly.h>

namespace lockstep {

/// An angle is known up to full turns; a start may ask for more than half of one, by a coordinate (AssemblyOptions) or by
/// the law of a drive at the state's time t:
///
///     theta = theta_0 + way,   theta_0 in (-pi, pi] of the poses that the bodies are given
///
/// Leads what counts turns and nothing else (Remembering::counts_turns_alone: links, forces) along these ways, from the
/// given poses on, so that it begins in the turn that is asked for: P, or S where P is held, turns about the axis of S with
/// all that it carries, or alone where it is part of a loop. Writes State::z alone, and only where it is as
/// System::start() left it. Returns whether it did. `warnings`: of an angle of more than half a turn that it does not lead
/// to, by name: about an axis beside which P turns freely, of more than 10000 turns, or that others turn away.
LOCKSTEP_API bool begin_turns(Dynamics&, State&, const AssemblyOptions&, std::vector<std::string>& warnings);

/// The same for a start that is not assembled, by the drives alone; logs the warnings.
LOCKSTEP_API void begin_turns(Dynamics&, State&);

/// Whether a start or a drive asks for an angle of more than half a turn, or for a place that a link which counts turns may
/// turn into one.
LOCKSTEP_API bool may_begin_beyond(const System&, const State&, const AssemblyOptions&);

/// Lets links and forces that count turns take the branches nearest to those before, at this state; the first time forces
/// take those within half a turn of zero.
void follow_turns(Dynamics&, State&);

/// The share of a step of 6 numbers a slot that turns no body by more than an eighth of a turn, so that the angles between
/// two of them can be followed. `length`: of what stands for a turn of 1 rad.
double short_share(int n_slots, const VecX& d, double length = 1);

/// The memory State::z where what counts turns is at these poses, from System::start().
VecX counted_at(Dynamics&, const State&);

/// Iterations come to a pose by other ways than begin_turns(), from where forces and stops are at the poses given. Those that
/// were led from zero by more than half a turn keep that memory; those that came by no more than half a turn begin as
/// they would without, within half a turn of zero. `given`, `led`: State::z before the iterations, as counted_at() and as
/// begin_turns() leave it.
void settle_turns(const System&, const VecX& given, const VecX& led, State&);

/// Whether the link holds the turns about the other two axes.
LOCKSTEP_API bool turns_about_one_axis(const Lock&, Axis);

/// Whether a link counts turns and remembers nothing else.
bool has_counting_links(const System&);

/// Whether a link in force is driven by a law of its place or angle.
bool has_drives(const System&, const State&);

/// Turns the bodies of open chains to where drives about axes begin that are more than a quarter turn from there. Returns
/// whether there are such drives, of loops too.
bool turn_to_drives(Dynamics&, State&);

/// The drive about an axis that begins farthest from where the poses are, more than a quarter turn, in words for messages:
/// " (drive rz of link 'A' begins at 180 deg, 180 deg from the poses given)"; "" for none.
std::string farthest_drive(Dynamics&, const State&);

/// The angle of P about an axis of S (0, 1, 2) that a law or what counts its turns says at this state, rad; nothing where
/// none does, or P turns about other axes, too.
LOCKSTEP_API std::optional<double> known_turn(const System&, const State&, const Lock&, int axis);

}  // namespace lockstep
