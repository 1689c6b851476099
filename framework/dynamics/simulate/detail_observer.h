// SPDX-License-Identifier: BSD-3-Clause
// DetailObserver: an observer that also receives states between the outputs of a run.
#pragma once

#include <lockstep/step_loop.h>

namespace lockstep {

/// Besides the calls of every observer it gets states inside of steps, where the method has dense output, and those just
/// before an event, an impact or the jump of a law acts. What it throws is an error of the run, as of every observer, but
/// for between(): there the state is left out.
class LOCKSTEP_API DetailObserver : public Observer {
 public:
  ~DetailObserver() override;
  /// How far apart the states inside of steps are, s; infinity: none are wanted.
  virtual double spacing() const = 0;
  /// A state inside of a step; before step() of its end. The run is the same whether it looks or not.
  virtual void between(const Sample&) = 0;
  /// The state just before something acts on it; jumped() follows, with the state after. The solution that it asks for
  /// is one of the run, as that of step().
  virtual void before_jump(const Sample&) = 0;
};

}  // namespace lockstep
