#include <lockstep/step_loop.h>
#include "framework/dynamics/simulate/detail_observer.h"

namespace lockstep {

DetailObserver::~DetailObserver() = default;

Observer::~Observer() = default;

void Observer::start(const Sample&) {}

void Observer::step(const Sample&) {}

void Observer::jumped(const Sample&) {}
void Observer::output(const Sample&) {}

void Observer::finish(const Sample&) {}

void Observer::save(Snapshot&) const {}

void Observer::load(const Snapshot&) {}

bool Observer::saves_all() const { return true; }

}  // namespace lockstep
