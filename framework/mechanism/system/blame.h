// Who threw: an exception of a link's, a force's or a law's code becomes one that names it.
#pragma once

#include <exception>
#include <string>
#include <typeinfo>

#include "framework/mechanism/forces/force.h"
#include "framework/mechanism/lock/lock.h"
#include "framework/foundation/support/error.h"

namespace lockstep {

class System;

/// "link 'A' (cam_follower of plugin cams)", "force 'F' (spring_damper)"
LOCKSTEP_API std::string label(const Lock&);
LOCKSTEP_API std::string label(const Force&);

/// What is wrong with one of its laws at time t, in words; "" when nothing is, or when the thing cannot tell.
LOCKSTEP_API std::string law_at_fault(const Lock&, double t);
LOCKSTEP_API std::string law_at_fault(const Force&, double t);

/// In a catch block: throws what is in flight as UserCodeError that names the thing, the law of it that threw, and the
/// time; with the original nested in it. What names its maker already (UserCodeError, NonFiniteError), and any Error of
/// a thing that no plugin brought and whose laws are sound, goes on as it is.
[[noreturn]] LOCKSTEP_API void rethrow_named(const Lock&, double t);
[[noreturn]] LOCKSTEP_API void rethrow_named(const Force&, double t);

/// Runs `act`, which calls the thing's code, and returns what it returns; costs nothing when nothing is thrown.
template <class Thing, class Act>
auto named(const Thing& thing, double t, Act&& act) -> decltype(act()) {
  try {
    return act();
  } catch (...) {
    rethrow_named(thing, t);
  }
}

/// In a catch block around a pass over many: asks one by one who throws, and throws that.
[[noreturn]] void rethrow_from_rows(const System&, const Inputs&, const RowTable&);
[[noreturn]] void rethrow_from_forces(const System&, const Inputs&);

/// The next move where a step was too long for what it met.
inline constexpr const char* kShorterStep =
    "make the step smaller, or take a method that chooses it (dopri5; radau5 where springs or dampers are stiff)";

/// Throws NonFiniteError naming the body, link, force or law that made a number that is not finite: in the motions, the
/// rows, or the forces `f` (6 per slot).
LOCKSTEP_API void check_finite(const System&, const Inputs&, const RowTable&, const VecX& f);
/// The same of the rates `sd` of State::s, one of which is not finite.
[[noreturn]] LOCKSTEP_API void diagnose_rates(const System&, double t, const VecX& sd);

/// Setup of a thing of a plugin: its ModelError keeps its type and gets the label in front.
template <class Thing>
void set_up(Thing& thing) {
  try {
    thing.setup();
  } catch (const ModelError& error) {
    // a class of its own carries more than words
    if (thing.origin().empty() || thing.origin() == "built in" || typeid(error) != typeid(ModelError)) throw;
    throw ModelError(label(thing) + ": " + error.what());
  } catch (...) {
    rethrow_named(thing, 0.0);
  }
}

}  // namespace lockstep
