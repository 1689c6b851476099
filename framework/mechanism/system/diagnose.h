// SPDX-License-Identifier: BSD-3-Clause
// Attribution of errors: whose code threw or computed a number that is not finite - a joint's, a force's or a law's.
#pragma once

#include <string>
#include <vector>

#include <lockstep/author/force.h>
#include <lockstep/author/lock.h>
#include <lockstep/detail/counted_angle.h>
#include <lockstep/error.h>

namespace lockstep {

class System;

/// Advice for a step that was too long.
inline constexpr const char* kShorterStep =
    "reduce the step, or use a method that chooses it (dopri5; radau5 for stiff springs or dampers)";

/// Kind, name, type and plugin. type() is user code: the type is "?" if it throws.
LOCKSTEP_API Thing thing_of(const Lock&);
LOCKSTEP_API Thing thing_of(const Force&);
/// Whether its rows contain more than the coordinates between its markers: a function, or laws.
LOCKSTEP_API bool has_function(const Lock&);
/// "first test cam by check_lock; otherwise ": the types of plugins that joints and forces with these names, or all,
/// have or whose laws they use; "" if there are none.
LOCKSTEP_API std::string tests_first(const System&, const std::vector<std::string>& names = {});
/// The joint that a row of the table belongs to; unnamed for a row that the table lacks.
LOCKSTEP_API Thing thing_of_row(const System&, const RowTable&, int row);

/// The active one-sided joints, and the joints whose laws may drive against them, by name: the end of "two laws may
/// drive one coordinate"; "" if none is active.
LOCKSTEP_API std::string or_against_stops(const System&, const RowTable&);

/// The context of errors thrown by its code at time t; names the law that is at fault, if one is.
LOCKSTEP_API ErrorContext context_of(const Lock&, double t);
LOCKSTEP_API ErrorContext context_of(const Force&, double t);
LOCKSTEP_API ErrorContext context_of(const Auxiliary&, double t);
LOCKSTEP_API ErrorContext context_of(const CountedAngle&, double t);

/// Setup of a joint or force: its errors reject the model and keep their type.
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

/// In a catch block around the gathering of a group: gathers its joints one by one and throws the first error by name.
[[noreturn]] void rethrow_from_group(const System&, const Inputs&, const RowTable&, const RowRun&);

/// Throws NonFiniteError naming the body, joint, force or law with a number that is not finite: in the motions, the
/// rows, or the forces `f` (6 per slot).
LOCKSTEP_API void check_finite(const System&, const Inputs&, const RowTable&, const VecX& f);
/// What a force exerts alone, 6 per slot: N (world) and N m (slot axes); zero while it does not act. With these reactions,
/// if it depends on reactions. Throws what it throws, by name.
LOCKSTEP_API VecX wrench_of(const System&, const Inputs&, const Force&, const Reactions* = nullptr);
/// Throws NonFiniteError naming the force and its bodies where its wrench is not finite.
LOCKSTEP_API void check_wrench(const System&, const Inputs&, const Force&);
/// Throws NonFiniteError: a law of the joint is not finite at t.
[[noreturn]] LOCKSTEP_API void refuse_laws(const Lock&, double t);
/// The same for the rates `sd` of State::s, one of which is not finite.
[[noreturn]] LOCKSTEP_API void diagnose_rates(const System&, double t, const VecX& sd);

}  // namespace lockstep
