// StepWatch: what the step loop finds out about each step itself, whatever the method reports. Internal to the step loop.
#pragma once

#include <lockstep/integrator.h>

namespace lockstep {

class StepWatch {
 public:
  StepWatch(Dynamics& dynamics, const Integrator& method)
      : dynamics_(dynamics), method_(method), is_built_in_(method.origin() == "built in") {}

  /// Checks the step of at most h, s, from `from` to `to`: time, finite numbers, unit quaternions. Of a method that is not
  /// built in also what it must not touch, and |C| of the new state, of which the larger one is reported. Throws StepError
  /// that names the method.
  void check(const State& from, const State& to, double h, StepReport& report);
  /// After n steps of the run, which depend on nothing else: |C| of a built-in method is measured again in steps 1, 2, 4
  /// and 8 and in every 16th, at less than the cost of an evaluation. `largest`, of the run as reported, is raised where it
  /// is not the truth.
  void check_again(const State& at, long n, double& largest);

 private:
  bool has_closures(const State& state) const { return !state.coordinates || state.coordinates->has_rows(); }

  Dynamics& dynamics_;
  const Integrator& method_;
  const bool is_built_in_;
};

}  // namespace lockstep
