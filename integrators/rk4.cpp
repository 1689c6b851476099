// SPDX-License-Identifier: BSD-3-Clause
// Source of the tableau: W. Kutta, Zeitschrift fuer Mathematik und Physik 46 (1901) 435.
#include <lockstep/integrators.h>

namespace lockstep {

namespace {

constexpr double kC[4] = {0, 0.5, 0.5, 1};
constexpr double kA[4][3] = {{}, {0.5}, {0, 0.5}, {0, 0, 1}};
constexpr double kB[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
constexpr EmbeddedScheme kScheme{"rk4", {4, 4, 4, 3, kA[0], kB, kC}};

}  // namespace

TypeInfo Rk4::type_info() { return {"rk4", "Runge-Kutta of order 4, fixed step: teaching, comparison, real time", {}}; }

Rk4::Rk4() : EmbeddedRungeKutta(kScheme, {.fixed = true}) {}

}  // namespace lockstep
