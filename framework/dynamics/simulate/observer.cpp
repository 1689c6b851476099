// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/step_loop.h>

#include <string>
#include <typeinfo>

#include "framework/dynamics/simulate/detail_observer.h"
#include "framework/dynamics/simulate/user_code.h"
#include "framework/foundation/support/thrown.h"

namespace lockstep {

DetailObserver::~DetailObserver() = default;

Observer::~Observer() = default;

void Observer::start(const Sample&) {}

void Observer::step(const Sample&) {}

void Observer::jumped(const Sample&) {}
void Observer::output(const Sample&) {}

void Observer::finish(const Sample&) {}

void Observer::save(Snapshot&) const {}

void Observer::load(SnapshotReader&) {}

bool Observer::saves_all() const { return true; }

bool Observer::keeps_rows() const { return false; }

namespace {

// Errors of lockstep's own code keep their words; anything else it throws is told like the host's.
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
