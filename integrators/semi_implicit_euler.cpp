// Source of the scheme: Hairer, Lubich & Wanner, Geometric Numerical Integration (2006), I.1.2.
#include "integrators/semi_implicit_euler.h"

#include "framework/dynamics/integrate/runge_kutta.h"

namespace lockstep {

TypeInfo SemiImplicitEuler::type_info() {
  return {
      "semi_implicit_euler", "velocities first, then positions; order 1, fixed step: games, real time, comparison", {}};
}

IntegratorInfo SemiImplicitEuler::info() const { return {"semi_implicit_euler", 1, false, false, 1}; }

void SemiImplicitEuler::begin(Dynamics&, const State& state) {
  rate_ = sized_like(state);
  end_ = state;
}

StepReport SemiImplicitEuler::step(Dynamics& dynamics, State& state, double h) {
  dynamics.rate(state, rate_);
  copy_motion(state, end_);
  end_.z = state.z;
  end_.v += h * rate_.v;
  end_.s += h * rate_.s;
  dynamics.advance(end_, h, end_.v);
  end_.t = state.t + h;
  const ProjectReport landed = land_or_throw(dynamics, end_, "semi_implicit_euler", state.t, h);
  take_motion(end_, state);
  StepReport report;
  report.h = h;
  report.violation = landed.before;
  report.violation_after = landed.after;
  return report;
}

}  // namespace lockstep
