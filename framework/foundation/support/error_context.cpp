#include <lockstep/error.h>

#include <exception>

#include "framework/foundation/support/thrown.h"

namespace lockstep {
namespace {

// A built-in law that refuses to be asked there: the end of a spline. It is the model that is wrong, whoever asks. Not one
// that refuses its parameters.
bool from_our_law(const Error& error) {
  return error.kind() == Error::Kind::model && error.key.empty() && error.thing.kind == "law" &&
         error.thing.origin == "built in";
}

}  // namespace

void rethrow_in(const ErrorContext& context) {
  const Thing& thing = context.thing;
  const std::string label = context.label.empty() ? thing.label() : context.label;
  try {
    throw;
  } catch (const UserCodeError&) {
    throw;
  } catch (const NonFiniteError&) {
    throw;
  } catch (Error& error) {
    const bool foreign = thing.of_a_plugin();
    if (context.refuses) {
      // an unsolvable mechanism is not the fault of the code that asked for a solution
      const bool its_own = error.kind() != Error::Kind::solve && error.kind() != Error::Kind::assembly;
      if (its_own) error.attribute(thing, foreign ? at_time(context.t) + label : "");
      throw;
    }
    if (!foreign && from_our_law(error)) {
      ModelError refused(context.fault.empty() ? error.what() : context.fault, {.thing = thing, .t = context.t});
      refused.attribute(thing, at_time(context.t) + context.before + label);
      std::throw_with_nested(refused);
    }
    if (!foreign && context.fault.empty()) {
      error.attribute(thing, "");
      throw;
    }
  } catch (...) {
    if (thing.origin == "built in" && context.fault.empty()) throw;
  }
  const std::string words =
      context.fault.empty() ? " threw: " + thrown_words(std::current_exception()) : ": " + context.fault;
  std::throw_with_nested(
      UserCodeError(at_time(context.t) + context.before + label + words, {.thing = thing, .t = context.t}));
}

}  // namespace lockstep
