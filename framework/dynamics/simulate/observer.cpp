// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/dynamics.h>
#include <lockstep/step_loop.h>

#include <string>
#include <typeinfo>

#include "framework/dynamics/simulate/user_code.h"
#include "framework/foundation/support/thrown.h"

namespace lockstep {

InsideStep::~InsideStep() = default;
Observer::~Observer() = default;

Sample::Sample(Dynamics& dynamics, const State& s, const StepReport& r, const Inputs* known)
    : state(s), report(r), dynamics_(dynamics), inputs_(known), read_(dynamics.inputs_read()) {}

const System& Sample::system() const { return dynamics_.system(); }

const Solution& Sample::values() const {
  if (!values_) values_ = &dynamics_.solution_at(state);
  return *values_;
}

const VecX& Sample::accelerations() const {
  if (!a_) a_ = values_ ? &values_->a : &dynamics_.accelerations(state);
  return *a_;
}

const Inputs& Sample::inputs() const {
  if (!inputs_ || read_ != dynamics_.inputs_read()) inputs_ = &dynamics_.inputs(state), read_ = dynamics_.inputs_read();
  return *inputs_;
}

const LinkWrench& Sample::wrench(const Lock& link, const Marker& at, int part) const {
  const Evaluated& v = values();
  if (last_.link != &link || last_.at != &at || last_.part != part)
    last_ = {&link, &at, part, Reactions(v).on_body_of(MarkerFrame(at), link, v.in, part)};
  return last_.wrench;
}

namespace {

// Errors of lockstep's own code keep their text; anything else it throws is reported like the host's.
[[noreturn]] void rethrow_of(ErrorContext context, const std::type_info& whose) {
  if (!is_of_lockstep(whose)) rethrow_in(context);
  try {
    throw;
  } catch (const Error&) {
    context.thing.origin = "built in";
    rethrow_in(context);
  } catch (...) {
    rethrow_in(context);
  }
}

}  // namespace

void rethrow_of_observer(const Observer& observer, std::size_t number, double t) {
  const std::string which = std::to_string(number + 1), type = type_words(typeid(observer));
  rethrow_of({.thing = {.kind = "observer", .name = which, .type = type},
              .t = t,
              .label = "observer " + which + " (" + type + ")"},
             typeid(observer));
}

void rethrow_of_function(const char* kind, const std::type_info& function, double t) {
  rethrow_of({.thing = {.kind = kind}, .t = t}, function);
}

}  // namespace lockstep
