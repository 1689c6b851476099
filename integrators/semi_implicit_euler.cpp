// SPDX-License-Identifier: BSD-3-Clause
// Source of the scheme: Hairer, Lubich & Wanner, Geometric Numerical Integration (2006), I.1.2.
#include <lockstep/integrators.h>

namespace lockstep {

TypeInfo SemiImplicitEuler::type_info() {
  return {"semi_implicit_euler", "velocities first, then positions; order 1, fixed step: teaching and comparison", {}};
}

IntegratorInfo SemiImplicitEuler::info() const { return {"semi_implicit_euler", 1, false, false, 1, true}; }

void SemiImplicitEuler::begin(Dynamics& dynamics, const State& state) {
  AdaptiveStepper::begin(dynamics, state);
  rate_ = sized_like(state);
}

double SemiImplicitEuler::start_step(Dynamics& dynamics, double h) {
  dynamics.rates(start_, rate_);
  return h;
}

Attempt SemiImplicitEuler::attempt(Dynamics& dynamics, double h) {
  copy_motion(start_, end_);
  end_.v += h * rate_.v;
  end_.s += h * rate_.s;
  dynamics.advance(end_, h, end_.v);
  end_.t = start_.t + h;
  return {.accepted = true};
}

}  // namespace lockstep
