// rk4: the classical Runge-Kutta method of order 4 with a fixed step, for teaching and comparison.
#pragma once

#include "framework/dynamics/integrate/integrator.h"
#include "framework/dynamics/integrate/runge_kutta.h"
#include "framework/mechanism/params/params.h"

namespace lockstep {

/// 4 evaluations a step, one projection. No error estimate, no dense output.
class LOCKSTEP_API Rk4 final : public Integrator {
 public:
  static TypeInfo type_info();

  IntegratorInfo info() const override;
  void begin(Dynamics&, const State&) override;
  StepReport step(Dynamics&, State&, double h) override;
  const EmbeddedScheme* scheme() const override;

 private:
  Stages stages_;
  State end_;
};

}  // namespace lockstep
