// StepWatch: what the step loop finds out about each step itself, whatever the method reports. Internal to the step loop.
#pragma once

#include <lockstep/integrator.h>

namespace lockstep {

class StepWatch {
 public:
  StepWatch(Dynamics& dynamics, const Integrator& method) : dynamics_(dynamics), method_(method) {}

  /// Checks the step of at most h, s, from `from` to `to`: time, sizes, finite numbers, unit quaternions, counted
  /// turns; what a method must not touch. Of a method that is not built in it measures |C| of the new state, too, and
  /// reports the larger one. Throws StepError that names the method.
  void check(const State& from, const State& to, double h, StepReport& report);

 private:
  Dynamics& dynamics_;
  const Integrator& method_;
};

}  // namespace lockstep
