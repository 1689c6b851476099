// Observer: looks at accepted states; never changes them.
#pragma once

#include "framework/dynamics/integrate/integrator.h"

namespace lockstep {

/// Views, valid during the call. `values` is evaluated only when asked for: accelerations and multipliers at this very
/// state.
class Sample {
 public:
  Sample(Dynamics& dynamics, const State& s, const StepReport& r) : state(s), report(r), dynamics_(dynamics) {}
  const State& state;
  const StepReport& report;
  const System& system() const { return dynamics_.system(); }
  /// a, lambda, rows and inputs at this state; solved at the first call.
  const Solution& values() const {
    if (!values_) values_ = &dynamics_.evaluate(state);
    return *values_;
  }
  Dynamics& dynamics() const { return dynamics_; }

 private:
  Dynamics& dynamics_;
  mutable const Solution* values_ = nullptr;
};

class LOCKSTEP_API Observer {
 public:
  virtual ~Observer();
  virtual void start(const Sample&);
  /// Every accepted step, the state at its end.
  virtual void step(const Sample&);
  /// The velocities jumped at the end of the step seen last (an impact, a link switched, the jump of a law): the same
  /// instant, the state from which the run goes on.
  virtual void jumped(const Sample&);
  /// Every output time (the times asked for, or every step when none were); the state interpolated by the method's
  /// dense output and projected, or landed on.
  virtual void output(const Sample&);
  virtual void finish(const Sample&);
};

}  // namespace lockstep
