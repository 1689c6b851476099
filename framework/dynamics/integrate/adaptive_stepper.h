// AdaptiveStepper: the step driver of every method that writes one attempt at a step: repeats attempts until one is
// accepted, shortens the step, puts its end on the constraints, reports.
#pragma once

#include <memory>

#include "framework/dynamics/integrate/integrator.h"
#include "framework/dynamics/integrate/runge_kutta.h"
#include "framework/dynamics/integrate/step_control.h"

namespace lockstep {

/// What came of one attempt at a step.
struct Attempt {
  bool accepted = false;  ///< the end of the step was found and is accurate enough
  double error = 0;       ///< estimate in tolerances, 1 = just met; 0 where there is none
  int iterations = 0;     ///< of Newton's method, for the control
  double next = 0;        ///< step to attempt next should this one be rejected, s; 0: the control's choice, or half
  bool shifted = false;   ///< rejected for where it ended, not for its error: the next step may grow
};

/// An attempt whose evaluation fails (NonFiniteError, SolveError) is rejected up to eight times, then the error is
/// rethrown; so is one whose end is far off the constraints before projection (end_is_near). Without a control it makes
/// fixed steps: nothing is estimated, an evaluation's error is thrown at once, and an end that cannot be projected is a
/// StepError.
class LOCKSTEP_API AdaptiveStepper : public Integrator {
 public:
  ~AdaptiveStepper() override;
  void begin(Dynamics&, const State&) override;
  StepReport step(Dynamics&, State&, double h) final;
  void set_tolerance(const Tolerance& tolerance) override { norm_.set(tolerance); }
  double first_step(Dynamics&, const State&, double largest) override;
  void save(Snapshot&) const override;
  void restore(const Snapshot&) override;

 protected:
  /// `order` of the guess of the first step. No control: fixed steps.
  AdaptiveStepper(int order, std::unique_ptr<StepControl> control);
  bool fixed() const { return !control_; }

  // What a method writes.
  /// What no attempt changes, from start(). Returns the step to attempt first, at most h.
  virtual double start_step(Dynamics&, double h) = 0;
  /// One attempt at a step of h from start(): its end into end_.
  virtual Attempt attempt(Dynamics&, double h) = 0;
  /// After acceptance: what the next step and dense output need. end_ is the end before, landed_ after projection.
  virtual void finish_step(Dynamics&, StepReport&) {}
  /// Puts the end of a step on the constraints.
  virtual ProjectReport project_end(Dynamics&, State&);
  /// What to do about a step that shrank to nothing, in words.
  virtual std::string advice() const;

  /// StepError of an implicit method with fixed steps.
  [[noreturn]] void newton_failed(double h, const char* advice) const;

  ErrorNorm norm_;
  State start_, end_, landed_;  // of the step: its beginning, its end before and after projection

 private:
  bool land(Dynamics&, double h, StepReport&);

  int order_;
  std::unique_ptr<StepControl> control_;
  StateRate f0_, f1_;  // scratch of the first step
};

}  // namespace lockstep
