// semi_implicit_euler: velocities first, then positions with the new velocities. The method of games and real time.
//
//   v1 = v + h a(t, q, v),  q1 = q (+) h v1 (exponential),  s1 = s + h s'(t, q, v)
#pragma once

#include "framework/dynamics/integrate/adaptive_stepper.h"
#include "framework/mechanism/params/params.h"

namespace lockstep {

/// Order 1, fixed step; 1 evaluation a step, one projection. No error estimate, no dense output.
class LOCKSTEP_API SemiImplicitEuler final : public AdaptiveStepper {
 public:
  static TypeInfo type_info();
  SemiImplicitEuler() : AdaptiveStepper(1, nullptr) {}

  IntegratorInfo info() const override;
  void begin(Dynamics&, const State&) override;

 private:
  double start_step(Dynamics&, double h) override;
  Attempt attempt(Dynamics&, double h) override;

  StateRate rate_;
};

}  // namespace lockstep
