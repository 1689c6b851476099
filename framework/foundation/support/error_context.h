// Whose code runs: the one way in which an exception is given the name of its culprit.
#pragma once

#include <limits>
#include <string>

#include "framework/foundation/support/error.h"

namespace lockstep {

/// Whose code threw, and how its errors name it. Made only once something was thrown, so that the passes pay nothing.
struct ErrorContext {
  Thing thing{};
  double t = std::numeric_limits<double>::quiet_NaN();  ///< simulated time, s; NaN: while it is made or set up
  std::string fault{};   ///< what is wrong with one of its laws, in words; "" when nothing is
  bool refuses = false;  ///< its Errors are refusals and keep their type: makers, setup, integrators
  std::string label{};   ///< as in messages; "": thing.label()
  std::string before{};  ///< in front of the label where it threw: "link 'A', law: the maker of "
};

/// In a catch block: throws what is in flight as an error that names its culprit.
/// - UserCodeError and NonFiniteError name it already and go on as they are.
/// - An Error of a class that no plugin brought and whose laws are sound goes on with the thing noted in its data. So
///   does every refusal, with the label in front of its words if a plugin refuses.
/// - Everything else (an int as well) becomes a UserCodeError with kind, name, plugin, law and time, and the original
///   nested in it. Only what is not an Error and comes from built-in code (std::bad_alloc) goes on as it is.
[[noreturn]] LOCKSTEP_API void rethrow_in(const ErrorContext&);

/// Runs `act` and returns what it returns; what it throws goes through rethrow_in(context()). Costs nothing unless
/// something is thrown.
template <class Context, class Act>
decltype(auto) in_context(Context&& context, Act&& act) {
  try {
    return act();
  } catch (...) {
    rethrow_in(context());
  }
}

/// The same for the code of a thing that has a context_of(thing, t): a link, a force, an integrator.
template <class T, class Act>
decltype(auto) named(const T& thing, double t, Act&& act) {
  return in_context([&] { return context_of(thing, t); }, static_cast<Act&&>(act));
}

}  // namespace lockstep
