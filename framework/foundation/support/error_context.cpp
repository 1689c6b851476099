// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/error.h>

#include <cmath>
#include <exception>
#include <new>
#include <string>
#include <typeinfo>

#include <lockstep/text.h>
#include "framework/foundation/support/thrown.h"

namespace lockstep {
namespace {

// A built-in law evaluated outside of its range, as beyond the end of a spline: the model is wrong, not the caller. Not
// one that rejects its parameters.
bool from_our_law(const Error& error) {
  return error.kind() == Error::Kind::model && error.key.empty() && error.thing.kind == "law" &&
         error.thing.origin == "built in";
}

// Whether an error has its thing and time already: nothing is added on its way to the host.
bool is_told(const Error& error) { return error.thing.known() && !std::isnan(error.t); }

// Puts thing and time into an error and in front of its sentence, without what the sentence begins with already.
void attribute_at(Error& error, const ErrorContext& context, const std::string& label) {
  const std::string said = what_of(error);
  if (std::isnan(error.t)) error.t = context.t;
  std::string front = said.starts_with("t = ") || std::isnan(error.t) ? "" : "t = " + text::number(error.t) + " s";
  if (!said.starts_with(context.thing.words())) front += (front.empty() ? "" : ": ") + label;
  error.attribute(context.thing, front);
}

template <class E>
void throw_copy_of(const Error& error, const ErrorContext& context, const std::string& label) {
  if (typeid(error) != typeid(E)) return;
  E copy(static_cast<const E&>(error));
  attribute_at(copy, context, label);
  std::throw_with_nested(std::move(copy));
}

// In a catch block: throws the error again, as one of its class with thing and time, and nests what was thrown. An error
// of a class that is derived from those of lockstep is itself what is thrown.
template <class... E>
[[noreturn]] void throw_attributed(Error& error, const ErrorContext& context, const std::string& label) {
  (throw_copy_of<E>(error, context, label), ...);
  attribute_at(error, context, label);
  throw;
}

[[noreturn]] void rethrow_told(Error& error, const ErrorContext& context, const std::string& label) {
  throw_attributed<Error, ModelError, ParameterError, AssemblyError, SolveError, StepError, NonFiniteError, PluginError,
                   SceneError, FileError, UserCodeError>(error, context, label);
}

// A maker rejected its input, or a method a step. What the mechanism does not let happen is not the fault of the
// code that asked for a solution.
[[noreturn]] void rethrow_refusal(Error& error, const ErrorContext& context, const std::string& label) {
  const bool ours = context.thing.origin == "built in", hosts = context.thing.origin.empty();
  if (error.kind() == Error::Kind::solve || error.kind() == Error::Kind::assembly || is_told(error)) throw;
  if (hosts && !std::isnan(context.t)) rethrow_told(error, context, label);
  const bool names_it = what_of(error).find(context.thing.words()) != std::string::npos;
  error.attribute(context.thing, ours || (hosts && names_it) ? "" : at_time(context.t) + label);
  if (std::isnan(error.t)) error.t = context.t;
  throw;
}

}  // namespace

void rethrow_in(const ErrorContext& context) {
  const Thing& thing = context.thing;
  const std::string label = context.label.empty() ? thing.label() : context.label;
  const bool ours = thing.origin == "built in", foreign = thing.of_a_plugin();
  try {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const InterruptedError&) {
    throw;
  } catch (Error& error) {
    const bool sound = context.fault.empty();
    const bool kept = error.kind() == Error::Kind::user_code || error.kind() == Error::Kind::non_finite;
    if (is_told(error) && (kept || !foreign)) throw;
    if (context.refuses) rethrow_refusal(error, context, label);
    if (!foreign && from_our_law(error)) {
      ModelError refused(sound ? what_of(error) : context.fault, {.thing = thing, .t = context.t});
      refused.attribute(thing, at_time(context.t) + label);
      std::throw_with_nested(refused);
    }
    if (!sound && error.kind() == Error::Kind::non_finite)
      std::throw_with_nested(
          NonFiniteError(at_time(context.t) + label + ": " + context.fault, {.thing = thing, .t = context.t}));
    if (sound && ours && !kept) {
      error.attribute(thing, "");
      throw;
    }
    if (sound && (!foreign || kept)) rethrow_told(error, context, label);
  } catch (...) {
    if (ours && context.fault.empty()) throw;
  }
  const std::string words =
      context.fault.empty() ? " threw: " + thrown_words(std::current_exception()) : ": " + context.fault;
  std::throw_with_nested(UserCodeError(at_time(context.t) + label + words, {.thing = thing, .t = context.t}));
}

}  // namespace lockstep
