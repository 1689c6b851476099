// dopri5: Dormand and Prince's pair of orders 5(4), error-controlled, with dense output of order 4. The default.
#pragma once

#include <memory>

#include "framework/mechanism/params/params.h"
#include "integrators/embedded_runge_kutta.h"

namespace lockstep {

/// 7 evaluations a step, one projection. With `fixed` it steps as told, without error control.
class LOCKSTEP_API Dopri5 final : public EmbeddedRungeKutta {
 public:
  static TypeInfo type_info();
  static std::unique_ptr<Integrator> make(const Params&);
  explicit Dopri5(EmbeddedOptions options);
  explicit Dopri5(bool fixed = false);

  IntegratorInfo info() const override;
};

}  // namespace lockstep
