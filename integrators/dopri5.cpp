// SPDX-License-Identifier: BSD-3-Clause
// Sources: J. R. Dormand & P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19; dense output by Shampine 1986, as in
// Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I (1993), II.5 and II.6.
#include <lockstep/integrators.h>

namespace lockstep {

namespace {

constexpr int kStages = 7;
constexpr double kC[kStages] = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
// The last row is the end of the step.
constexpr double kA[kStages][kStages] = {{},
                                         {1.0 / 5},
                                         {3.0 / 40, 9.0 / 40},
                                         {44.0 / 45, -56.0 / 15, 32.0 / 9},
                                         {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
                                         {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
                                         {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
constexpr double kError[kStages] = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                    -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
constexpr double kDense[kStages] = {-12715105075.0 / 11282082432,  0,
                                    87487479700.0 / 32700410799,   -10690763975.0 / 1880347072,
                                    701980252875.0 / 199316789632, -1453857185.0 / 822651844,
                                    69997945.0 / 29380423};
constexpr EmbeddedScheme kScheme{
    "dopri5", {5, kStages, kStages, kStages, kA[0], kA[6], kC}, 6, 5, 3.25, kError, nullptr, 1, kDense};

}  // namespace

TypeInfo Dopri5::type_info() {
  return {"dopri5", "Runge-Kutta of order 5 with error control and dense output: the default", EmbeddedOptions::keys()};
}

std::unique_ptr<Integrator> Dopri5::make(const Params& params) {
  return std::make_unique<Dopri5>(EmbeddedOptions::from(params));
}

Dopri5::Dopri5(EmbeddedOptions options) : EmbeddedRungeKutta(kScheme, options) {}

Dopri5::Dopri5(bool fixed) : Dopri5(EmbeddedOptions{fixed}) {}

}  // namespace lockstep
