// Observer: is called with the accepted states of a run; never changes them.
#pragma once

#include "framework/dynamics/integrate/integrator.h"
#include "framework/mechanism/lock/reactions.h"

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
  /// What a link does to the body of one of its markers, as Reactions::on_body_of; computed once for all channels that
  /// ask one after the other.
  const LinkWrench& wrench(const Lock& link, const Marker& at, int part = Reactions::kJoint) const {
    const Evaluated& v = values();
    if (last_.link != &link || last_.at != &at || last_.part != part)
      last_ = {&link, &at, part, Reactions(v).on_body_of(MarkerFrame(at), link, v.in, part)};
    return last_.wrench;
  }
  Dynamics& dynamics() const { return dynamics_; }

 private:
  struct Asked {
    const Lock* link = nullptr;
    const Marker* at = nullptr;
    int part = 0;
    LinkWrench wrench;
  };
  Dynamics& dynamics_;
  mutable const Solution* values_ = nullptr;
  mutable Asked last_;
};

class LOCKSTEP_API Observer {
 public:
  virtual ~Observer();
  virtual void start(const Sample&);
  /// Every accepted step, with the state at its end.
  virtual void step(const Sample&);
  /// The velocities jumped at the end of the last step (an impact, a link switched, the jump of a law): the same
  /// instant, the state from which the run goes on.
  virtual void jumped(const Sample&);
  /// Every output time (the times asked for, or every step when none were): the state interpolated by the method's
  /// dense output and projected, or the end of a step.
  virtual void output(const Sample&);
  virtual void finish(const Sample&);
};

}  // namespace lockstep
