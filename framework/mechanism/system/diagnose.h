// Who made what went wrong: an exception of a link's, a force's or a law's code, or a number that is not finite.
#pragma once

#include <string>

#include <lockstep/error.h>
#include <lockstep/force.h>
#include <lockstep/lock.h>

namespace lockstep {

class System;

/// The next move where a step was too long for what it met.
inline constexpr const char* kShorterStep =
    "make the step smaller, or take a method that chooses it (dopri5; radau5 where springs or dampers are stiff)";

/// Kind, name, type and plugin. A class's type() is the user's code: one that throws is "?".
LOCKSTEP_API Thing thing_of(const Lock&);
LOCKSTEP_API Thing thing_of(const Force&);
/// The link that a row of the table belongs to; no name for a row that the table has not.
LOCKSTEP_API Thing thing_of_row(const System&, const RowTable&, int row);

/// For errors that leave its code at time t; says which of its laws is at fault then.
LOCKSTEP_API ErrorContext context_of(const Lock&, double t);
LOCKSTEP_API ErrorContext context_of(const Force&, double t);

/// Setup of a link or force: its errors are refusals and keep their type.
template <class T>
void set_up(T& thing) {
  in_context(
      [&] {
        ErrorContext context = context_of(thing, 0.0);
        context.t = std::numeric_limits<double>::quiet_NaN();
        context.refuses = true;
        return context;
      },
      [&] { thing.setup(); });
}

/// In a catch block around the gathering of one group: asks its links one by one who throws, and throws that.
[[noreturn]] void rethrow_from_group(const System&, const Inputs&, const RowTable&, const RowRun&);

/// Throws NonFiniteError naming the body, link, force or law that made a number that is not finite: in the motions, the
/// rows, or the forces `f` (6 per slot).
LOCKSTEP_API void check_finite(const System&, const Inputs&, const RowTable&, const VecX& f);
/// The same of the rates `sd` of State::s, one of which is not finite.
[[noreturn]] LOCKSTEP_API void diagnose_rates(const System&, double t, const VecX& sd);

}  // namespace lockstep
