// The numbers of the explicit methods, for those who step in another way than one state at a time.
#pragma once

#include "integrators/embedded_runge_kutta.h"

namespace lockstep {

const EmbeddedScheme& dopri5_scheme();
const EmbeddedScheme& dop853_scheme();
const Tableau& rk4_tableau();

}  // namespace lockstep
