// SPDX-License-Identifier: BSD-3-Clause
// The table of findings: code, severity, cause and cure of every kind.
#pragma once

#include <lockstep/finding.h>

namespace lockstep::finding {

// -- the result is wrong
inline constexpr FindingKind energy_not_conserved{
    "energy-not-conserved", Severity::wrong,
    "What forces and drives did does not add up to the change of energy. Steps are too coarse, a singular position was "
    "passed, or the potential, dissipation or supply of a force does not fit what it exerts.",
    "Take a smaller tolerance or step. Check forces of plugins by check_force()."};
inline constexpr FindingKind constraints_drifted{
    "constraints-drifted", Severity::wrong,
    "Constraints are violated by more than the limit: without projection their error accumulates.",
    "Project the end of each step: \"stabilization\": \"project\"."};

// -- the result may be wrong
inline constexpr FindingKind tolerance_not_reached{
    "tolerance-not-reached", Severity::doubt,
    "The integrator could not make a step small enough for the tolerance; the run went on with what can be reached.",
    "Take a larger tolerance, or look at the instant that is named: a contact, an impact or a singular position."};
inline constexpr FindingKind singular_passed{
    "singular-position-passed", Severity::doubt,
    "The mechanism passed a position where its constraints lose rank, and the method evaluated off the constraints.",
    "Take the integrator dop853 with its default stages, and project."};
inline constexpr FindingKind reactions_uncertain{
    "reactions-uncertain", Severity::doubt,
    "A recorded reaction is so near a singular position that rounding decides it.",
    "Look at the values before and after that instant."};
inline constexpr FindingKind not_certified{
    "not-certified", Severity::doubt,
    "A second run with a tighter tolerance or with another method agrees in no digit of a recorded column.",
    "Take a smaller tolerance; of chaotic motion record what does not depend on the start."};
inline constexpr FindingKind start_far{"start-far", Severity::doubt,
                                       "The assembled start is farther from the given poses than --within allows.",
                                       "Give poses that fit the links; `lockstep assemble` prints them."};

// -- probably not what was meant
inline constexpr FindingKind renamed_key{"renamed-key", Severity::warning,
                                         "A key of the scene, or of --set, has its old name.", "Write the new name."};
inline constexpr FindingKind not_included{
    "not-included", Severity::warning,
    "A key of an included scene that only the scene itself may give, and it does not.",
    "Give the key in the scene that includes the other."};
inline constexpr FindingKind held_turn{
    "held-turn", Severity::warning,
    "A coupling of turns names a joint that does not turn about its z axis, so that it holds the other one.",
    "Name a joint that turns about its z axis."};
inline constexpr FindingKind quaternion_length{"quaternion-length", Severity::warning,
                                               "A quaternion is not of length one; its direction is taken.",
                                               "Give its four numbers with more digits, scalar first."};
inline constexpr FindingKind negative_stiffness{"negative-stiffness", Severity::warning,
                                                "A spring with a negative stiffness pushes away from its free length.",
                                                "Take a positive stiffness, unless an unstable equilibrium is meant."};
inline constexpr FindingKind outputs_beyond_end{"outputs-beyond-end", Severity::warning,
                                                "An output was asked for at an instant that the run does not reach.",
                                                "Let the run last longer, or ask for less."};
inline constexpr FindingKind setting_unused{"setting-unused", Severity::warning, "A setting has no effect on this run.",
                                            "Leave it out, or take the method that reads it."};
inline constexpr FindingKind length_repeated{"length-repeated", Severity::warning,
                                             "A length that is varied is written in other places too, which stay.",
                                             "Make it one parameter, or name a point."};
inline constexpr FindingKind switches_unresolved{
    "switches-unresolved", Severity::warning,
    "Comparisons of a formula are equal over a span, so that no instant is one.",
    "Write the formula with fewer comparisons, min and max."};
inline constexpr FindingKind turns_uncertain{
    "turns-uncertain", Severity::warning,
    "The angle of a channel went faster than its rate: it passed a place where it has no value, or steps are too long.",
    "Record an angle about another axis, or take smaller steps."};
inline constexpr FindingKind start_moved{"start-moved", Severity::warning,
                                         "Assembly moved or turned a body far from its start pose.",
                                         "Give a pose that fits its links; `lockstep assemble` prints one."};
inline constexpr FindingKind start_speed_lost{"start-speed-lost", Severity::warning,
                                              "The links do not allow the start velocities that bodies are given.",
                                              "Give fitting velocities, or one start speed of a link."};
inline constexpr FindingKind start_missed{"start-missed", Severity::warning,
                                          "A coordinate does not begin where the start asks for it.",
                                          "Ask for it exactly, or leave the poses of its bodies free."};
inline constexpr FindingKind singular_start{
    "singular-start", Severity::warning,
    "The mechanism starts where its constraints lose rank, so that it may go on in several ways.",
    "Start beside the position, or give a velocity along one of the ways."};
inline constexpr FindingKind no_freedom{"no-freedom", Severity::warning,
                                        "The constraints leave no degree of freedom, and nothing drives the mechanism.",
                                        "Let one of the links leave free what should move."};
inline constexpr FindingKind violated_in_run{"violated-in-run", Severity::warning,
                                             "The constraints were violated by more than the limit after a step.",
                                             "Project the end of each step: \"stabilization\": \"project\"."};
inline constexpr FindingKind long_turn{"long-turn", Severity::warning,
                                       "A body turned too far in a step for a method that does not control its error.",
                                       "Take a smaller step, or a method that chooses its own."};
inline constexpr FindingKind long_steps{"long-steps", Severity::warning,
                                        "Outputs are closer than the fixed step, and the method cannot interpolate.",
                                        "Ask for outputs less often, or take smaller steps."};
inline constexpr FindingKind event_at_zero{
    "event-at-zero", Severity::warning,
    "The condition of an event is zero, or has passed zero, when it begins to count.",
    "Begin beside it. The event happens when its condition passes zero again."};

// -- facts
inline constexpr FindingKind energy_not_judged{"energy-not-judged", Severity::note,
                                               "A force gives power and no potential, dissipation or supply.",
                                               "Let the force give them, or check the result by other means."};
inline constexpr FindingKind energy_suspect{"energy-suspect", Severity::note,
                                            "What may have spoiled the energy balance of the run.",
                                            "See the finding itself."};
inline constexpr FindingKind event_missed{"event-missed", Severity::note, "An event did not happen.",
                                          "Let the run last longer, or ask for a value that is reached."};
inline constexpr FindingKind stiff{"stiff", Severity::note, "Damped fast motion limited the steps, not accuracy.",
                                   "Take an implicit method: radau5 or generalized_alpha."};
inline constexpr FindingKind reactions_not_unique{
    "reactions-not-unique", Severity::note,
    "Constraints are redundant, so that the solver decides how they share a load.",
    "Let joints leave free what others hold, or add the compliance that decides it."};
inline constexpr FindingKind nearly_redundant{
    "nearly-redundant", Severity::note, "Constraints depend on each other but for small errors of lengths or angles.",
    "Correct the geometry, or say whether they hold: \"nearly_redundant\"."};
inline constexpr FindingKind analysis_note{"analysis-note", Severity::note,
                                           "What an analysis held, left out or assumed.", "See the finding itself."};

}  // namespace lockstep::finding
