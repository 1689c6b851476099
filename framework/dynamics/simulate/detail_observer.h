// DetailObserver: an observer that is also told what lies between the outputs of a run.
#pragma once

#include <lockstep/step_loop.h>

namespace lockstep {

/// Besides the calls of every observer it gets states inside of steps, where the method has dense output, and those just
/// before an event, an impact or the jump of a law acts. It must not throw: what it sees is no part of the run's results.
class LOCKSTEP_API DetailObserver : public Observer {
 public:
  ~DetailObserver() override;
  /// How far apart the states inside of steps are, s; infinity: none are wanted.
  virtual double spacing() const = 0;
  /// A state inside of a step; before step() of its end.
  virtual void between(const Sample&) = 0;
  /// The state just before something acts on it; jumped() follows, with the state after.
  virtual void before_jump(const Sample&) = 0;
};

}  // namespace lockstep
