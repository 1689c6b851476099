// SPDX-License-Identifier: BSD-3-Clause
// The table of findings: code, severity, cause and cure of every kind.
#pragma once

#include <lockstep/finding.h>

namespace lockstep::finding {

// -- the result is wrong
inline constexpr FindingKind energy_not_conserved{
    "energy-not-conserved", Severity::wrong,
    "The energy balance does not close. Steps are too coarse, a singular configuration was passed, a custom joint or "
    "law has a wrong derivative, or the potential, dissipation or supply of a force does not fit its load.",
    "First test custom types in C++: check_lock(), check_law(), check_force(). Otherwise reduce the tolerance "
    "(--tolerance) or the step (--step)."};
inline constexpr FindingKind constraints_drifted{
    "constraints-drifted", Severity::wrong,
    "The constraint violation exceeds the limit; without projection it accumulates.",
    "Project after each step: \"stabilization\": \"project\"."};

inline constexpr FindingKind requirement_broken{
    "requirement-broken", Severity::wrong, "A condition of \"require\" does not hold at some time of the run.",
    "Look at the reported time, by a report; change the mechanism, or the condition."};

// -- the result may be wrong
inline constexpr FindingKind tolerance_not_reached{
    "tolerance-not-reached", Severity::doubt,
    "The step could not be made small enough for the tolerance; the run continued with a larger error.",
    "Increase the tolerance, or examine the reported time: a contact, an impact or a singular configuration."};
inline constexpr FindingKind singular_passed{
    "singular-position-passed", Severity::doubt,
    "The mechanism passed a singular configuration while the stages of the integrator were not projected.",
    "Use dop853 with its default stages and with projection."};
inline constexpr FindingKind reactions_uncertain{
    "reactions-uncertain", Severity::doubt,
    "A recorded reaction is so close to a singular configuration that round-off determines it.",
    "Use the values before and after that time."};
inline constexpr FindingKind inertia_lost{
    "inertia-lost", Severity::doubt,
    "The inertia of a body about an axis is below what rounding leaves of its mass times the square of its length.",
    "Give it the inertia of a real body about that axis."};
inline constexpr FindingKind depends_on_share{
    "depends-on-share", Severity::doubt,
    "Friction, an event or a requirement reads a reaction that is not unique: the solver chooses how loads are shared.",
    "Release the redundant constraints, or add the compliance that determines the reactions."};
inline constexpr FindingKind not_certified{
    "not-certified", Severity::doubt,
    "A second run with a tighter tolerance or another method does not agree in any digit of a recorded column.",
    "Reduce the tolerance; for chaotic motion, record quantities that do not depend on the initial conditions."};
inline constexpr FindingKind units_ignored{
    "units-ignored", Severity::doubt,
    "The name of a column of a CSV file ends in a unit without brackets, such as "
    "time_ms, so its numbers are read in SI.",
    "Write the unit in brackets: \"time [ms]\"."};
inline constexpr FindingKind start_far{"start-far", Severity::doubt,
                                       "The assembled start is farther from the given poses than --within allows.",
                                       "Give poses that fit the joints; `lockstep assemble` prints them."};

// -- probably not what was meant
inline constexpr FindingKind implausible{
    "implausible", Severity::warning,
    "Gravity, an inertia for its mass, the distance of a centre of mass or an angle without a unit is too large.",
    "Give numbers in m, kg, s and rad, or with their units, as \"500 mm\" and \"45 deg\"."};
inline constexpr FindingKind not_included{
    "not-included", Severity::warning,
    "An included scene has a key that is read from the main scene only, and the main scene does not give it.",
    "Give the key in the main scene."};
inline constexpr FindingKind held_turn{
    "held-turn", Severity::warning,
    "A coupling of rotations uses a joint that cannot rotate about its z axis, which locks the other joint.",
    "Use a joint that rotates about its z axis."};
inline constexpr FindingKind quaternion_length{"quaternion-length", Severity::warning,
                                               "A quaternion does not have unit length; it was normalised.",
                                               "Give its four components with more digits, scalar first."};
inline constexpr FindingKind negative_stiffness{
    "negative-stiffness", Severity::warning, "A spring with a negative stiffness pushes away from its free length.",
    "Use a positive stiffness, unless an unstable equilibrium is intended."};
inline constexpr FindingKind outputs_beyond_end{"outputs-beyond-end", Severity::warning,
                                                "An output was requested at a time that the run does not reach.",
                                                "Extend the run, or request fewer outputs."};
inline constexpr FindingKind setting_unused{"setting-unused", Severity::warning, "A setting has no effect on this run.",
                                            "Remove it, or use the method that reads it."};
inline constexpr FindingKind length_repeated{"length-repeated", Severity::warning,
                                             "A changed length is also given in other places, which do not change.",
                                             "Make it one parameter, or refer to a named point."};
inline constexpr FindingKind switches_unresolved{"switches-unresolved", Severity::warning,
                                                 "The sides of a comparison in a formula differ only by round-off over "
                                                 "an interval, so its switching times are undefined.",
                                                 "Write the formula with fewer comparisons, min and max."};
inline constexpr FindingKind turns_uncertain{"turns-uncertain", Severity::warning,
                                             "The angle of a channel changed faster than its rate: it passed a point "
                                             "at which it is undefined, or steps are too long.",
                                             "Record an angle about another axis, or use smaller steps."};
inline constexpr FindingKind start_moved{
    "start-moved", Severity::warning,
    "Assembly moved a body by more than a thousandth of the mechanism's length, or rotated it by more than 0.001 rad, "
    "and neither a drive nor \"start\" requests it.",
    "Check the places of its joints first (\"at_p\" and \"at_s\" are in world axes), then its pose; "
    "`lockstep assemble` prints one that fits."};
inline constexpr FindingKind start_speed_lost{"start-speed-lost", Severity::warning,
                                              "The joints do not allow the given start velocities of bodies.",
                                              "Give compatible velocities, or one start speed of a joint."};
inline constexpr FindingKind start_changed{
    "start-changed", Severity::warning,
    "A stated start velocity of a body or a joint is not the one with which the run begins.",
    "State velocities that fit each other, or leave out those that follow from others."};
inline constexpr FindingKind start_missed{"start-missed", Severity::warning,
                                          "A coordinate does not begin at the requested value.",
                                          "Request a value that the joints allow, by \"position\", or set "
                                          "\"assembled\": \"free\" for its bodies."};
inline constexpr FindingKind singular_start{
    "singular-start", Severity::warning,
    "Loops start in a singular configuration, from which they can continue in several ways, also if a drive moves "
    "them. "
    "More than 300 constraints in loops are not tested.",
    "Start near that configuration. Without drives, a velocity along one of the possible motions is enough."};
inline constexpr FindingKind no_freedom{
    "no-freedom", Severity::warning,
    "The constraints leave no degree of freedom, and no law moves the mechanism. A drive with a constant law holds its "
    "joint.",
    "Use a joint that leaves the intended motion free. For a constant speed, give the drive \"speed\" instead of "
    "\"law\"."};
inline constexpr FindingKind violated_in_run{"violated-in-run", Severity::warning,
                                             "The constraint violation exceeded the limit after a step.",
                                             "Project after each step: \"stabilization\": \"project\"."};
inline constexpr FindingKind long_turn{"long-turn", Severity::warning,
                                       "A body rotated too far in one step of a method without error control.",
                                       "Use a smaller step, or a method that chooses its step."};
inline constexpr FindingKind long_steps{"long-steps", Severity::warning,
                                        "Outputs are closer than the fixed step, and the method cannot interpolate.",
                                        "Request fewer outputs, or use smaller steps."};
inline constexpr FindingKind event_at_zero{
    "event-at-zero", Severity::warning,
    "The condition of an event is zero, or has passed zero, when the event becomes active.",
    "Begin away from zero. The event happens when its condition passes zero again."};
inline constexpr FindingKind stop_passed{
    "stop-passed", Severity::warning,
    "A prescribed motion passes a stop or another one-sided joint, which kinematics and inverse dynamics do not test.",
    "End the motion before it, or move the stop."};
inline constexpr FindingKind friction_damps{
    "friction-damps", Severity::warning,
    "In linear equations, joint friction at rest acts as a damper: the slope of its smoothed law, mu "
    "N/smoothing_speed.",
    "Set \"mu\" to 0 for modes without friction, or choose the smoothing_speed that gives the intended damping."};

// -- facts
inline constexpr FindingKind energy_not_judged{"energy-not-judged", Severity::note,
                                               "A force does work but gives no potential, dissipation or supply.",
                                               "Let the force give them, or check the result by other means."};
inline constexpr FindingKind energy_suspect{
    "energy-suspect", Severity::note,
    "A possible cause of the energy error of the run: a force, a singular configuration, the constraint violation, the "
    "work of drives, or long steps.",
    "If it names a force, correct the force. Otherwise use projection, or shorten the steps."};
inline constexpr FindingKind event_missed{"event-missed", Severity::note, "An event did not happen.",
                                          "Extend the run, or use a value that is reached."};
inline constexpr FindingKind stiff{"stiff", Severity::note,
                                   "The model is stiff: strongly damped fast motion, not accuracy, limited the steps.",
                                   "An implicit method may be cheaper, such as radau5: compare by `lockstep advise`."};
inline constexpr FindingKind reactions_not_unique{
    "reactions-not-unique", Severity::note,
    "Constraints are redundant, so individual reactions are not unique: the solver chooses how they share a load.",
    "Release the redundant constraints, or add the compliance that determines the reactions."};
inline constexpr FindingKind nearly_redundant{
    "nearly-redundant", Severity::note, "Constraints are redundant except for small errors of lengths or angles.",
    "Correct the geometry, or choose whether they hold: \"nearly_redundant\"."};
inline constexpr FindingKind units_assumed{"units-assumed", Severity::note,
                                           "Columns of a CSV file have no units in the header, so they are read in SI.",
                                           "Write the units in brackets: \"time [ms],torque [N mm]\"."};
inline constexpr FindingKind analysis_note{
    "analysis-note", Severity::note,
    "An analysis held, left out or assumed something, such as an open one-sided joint, friction or a moving marker.",
    "Check that the assumption fits the model."};

}  // namespace lockstep::finding
