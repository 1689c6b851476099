// dop853: Dormand and Prince's method of order 8 with error estimates of orders 5 and 3, dense output of order 7. The
// accurate choice.
#pragma once

#include <memory>

#include "framework/mechanism/params/params.h"
#include "integrators/embedded_runge_kutta.h"

namespace lockstep {

/// 12 evaluations a step, one projection; 4 more in a step in which dense output is asked for. With `fixed` it steps as
/// told, without error control.
class LOCKSTEP_API Dop853 final : public EmbeddedRungeKutta {
 public:
  static TypeInfo type_info();
  static std::unique_ptr<Integrator> make(const Params&);
  explicit Dop853(EmbeddedOptions options);
  explicit Dop853(bool fixed = false);

  IntegratorInfo info() const override;
};

}  // namespace lockstep
