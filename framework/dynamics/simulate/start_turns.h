// Where the counts of turns begin. Internal to assembly and to channels.
#pragma once

#include <optional>

#include <lockstep/assembly.h>

namespace lockstep {

/// An angle is known up to full turns; a start may ask for more than half of one, by a coordinate (AssemblyOptions) or by
/// the law of a drive at the state's time t:
///
///     theta = theta_0 + way,   theta_0 in (-pi, pi] of the poses that the bodies are given
///
/// Leads what counts turns (links, forces) along these ways, from the given poses on, so that it begins in the turn that
/// is asked for: P turns about the axis of S with all that it carries, or alone where it is part of a loop. Writes
/// State::z alone, and only where it is as System::start() left it. Returns whether it did. Warns by name of an angle of
/// more than half a turn that it cannot lead to: about an axis beside which P turns freely, or of more than 10000 turns.
LOCKSTEP_API bool begin_turns(Dynamics&, State&, const AssemblyOptions&);

/// Lets links and forces that count turns take the branches nearest to those before, at this state.
void follow_turns(Dynamics&, State&);

/// Iterations come to a pose by other ways than begin_turns(): forces and stops that it led from `home` by more than half a
/// turn keep their memory `led`, State::z.
void keep_led_turns(const System&, const VecX& home, const VecX& led, State&);

/// Whether a link counts turns and remembers nothing else.
bool has_counting_links(const System&);

/// Turns the bodies of open chains to where drives about axes begin that are more than a quarter turn from there. Returns
/// whether there are such drives, of loops too.
bool turn_to_drives(Dynamics&, State&);

/// The drive about an axis that begins farthest from where the poses are, more than a quarter turn, in words for messages:
/// " (drive rz of link 'A' begins at 180 deg, 180 deg from the poses given)"; "" for none.
std::string farthest_drive(Dynamics&, const State&);

/// The angle of P about an axis of S (0, 1, 2) that a law or what counts its turns says at this state, rad; nothing where
/// none does.
LOCKSTEP_API std::optional<double> known_turn(const System&, const State&, const Lock&, int axis);

}  // namespace lockstep
