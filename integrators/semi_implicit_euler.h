// semi_implicit_euler: velocities first, then positions with the new velocities. The method of games and real time.
//
//   v1 = v + h a(t, q, v),  q1 = q (+) h v1 (exponential),  s1 = s + h s'(t, q, v)
#pragma once

#include "framework/dynamics/integrate/integrator.h"
#include "framework/mechanism/params/params.h"

namespace lockstep {

/// Order 1, fixed step; 1 evaluation a step, one projection. No error estimate, no dense output.
class LOCKSTEP_API SemiImplicitEuler final : public Integrator {
 public:
  static TypeInfo type_info();

  IntegratorInfo info() const override;
  void begin(Dynamics&, const State&) override;
  StepReport step(Dynamics&, State&, double h) override;

 private:
  StateRate rate_;
  State end_;
};

}  // namespace lockstep
