// rk4: the classical Runge-Kutta method of order 4 with a fixed step, for teaching and comparison.
#pragma once

#include "integrators/embedded_runge_kutta.h"

namespace lockstep {

/// 4 evaluations a step, one projection. No error estimate, no dense output.
class LOCKSTEP_API Rk4 final : public EmbeddedRungeKutta {
 public:
  static TypeInfo type_info();
  Rk4();

  IntegratorInfo info() const override;
};

}  // namespace lockstep
