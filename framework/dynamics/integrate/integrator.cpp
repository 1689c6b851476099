#include <lockstep/integrator.h>

#include <typeinfo>

#include "framework/foundation/support/thrown.h"

namespace lockstep {

Integrator::~Integrator() = default;

bool Integrator::dense(double, State&) const { return false; }

void Integrator::set_tolerance(const Tolerance&) {}

double Integrator::first_step(Dynamics&, const State&, double) { return 0; }

const EmbeddedScheme* Integrator::scheme() const { return nullptr; }

void Integrator::save(Snapshot&) const {}

void Integrator::restore(SnapshotReader&) {}

bool Integrator::saves_all() const { return true; }

ErrorContext context_of(const Integrator& method, double t) {
  const bool ours = method.origin().empty() && is_of_lockstep(typeid(method));  // made in C++
  ErrorContext context{.thing = {.kind = "integrator", .name = "?", .origin = ours ? "built in" : method.origin()},
                       .t = t,
                       .refuses = true};
  try {
    context.thing.name = method.info().name;
  } catch (...) {  // info() is user code, too; the name stays "?"
  }
  return context;
}

}  // namespace lockstep
