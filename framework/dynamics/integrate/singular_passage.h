// SingularPassage: how an explicit method passes singular positions, where the rows do not determine the accelerations.
//
// Near one its stages are evaluated on the constraints; a step whose late stage is ill-conditioned, or whose estimate is
// spoilt by such a stage, is moved: a slightly different one ends elsewhere.
#pragma once

#include "framework/dynamics/integrate/runge_kutta.h"
#include "framework/dynamics/integrate/singular_rate.h"
#include "framework/foundation/support/snapshot.h"

namespace lockstep {

/// Where the stages are evaluated: as they are, on the constraints (see StagesOn), or on the constraints while a stage
/// is near a singular position: when the singularity indicator (SolveReport::detector) falls under 1e-2, until it is
/// above 3e-2.
enum class StagesWhen { plain, manifold, automatic };

class LOCKSTEP_API SingularPassage {
 public:
  SingularPassage(StagesWhen when, const char* method) : when_(when), method_(method) {}
  void begin(const State&);
  /// Whether it needs the conditioning of the stages.
  bool active() const { return when_ != StagesWhen::plain; }
  void set_tolerance(double relative) { relative_ = relative; }

  // -- a step from y
  void start_step();
  StagesOn stages_on() const { return on_; }
  /// The first stage into `stages`; in a singular position its rates come from both sides of it (SingularRate). False:
  /// it could not be brought onto the constraints. StepError where several motions go on from the start of a run.
  bool first_stage(Dynamics&, const State& y, Stages& stages);
  /// h, or less: with its stages on the constraints a step turns no body by more than 0.5 rad.
  double longest(const State& y, double h) const;
  /// True when an attempt came near a singular position and must be repeated with its stages on the constraints.
  bool enters(const Stages&);
  /// Whether an attempt of this error should be moved rather than accepted or rejected.
  bool must_shift(const Stages&, int late_stage, double error) const;
  /// The step to attempt instead of h; after a dozen of them the best, with a larger limit of its error.
  double shift(const Stages&, int late_stage, double h, double error);
  /// Errors up to this are accepted.
  double limit() const { return limit_; }
  /// After acceptance: where the next step begins.
  void finish_step(const Stages&);

  /// First step from y; one that begins in a singular position leads out of it.
  double first_step(Dynamics&, const State& y, Stages&, double guess, double largest);
  bool near(const Stages& stages) const;

  void save(Snapshot& out) const { out.put(near_ ? 1 : 0); }
  void restore(const Snapshot& in) { near_ = in.get() != 0; }

 private:
  bool ill_conditioned(const Stages&, int stage) const;

  StagesWhen when_;
  const char* method_;
  double relative_ = 1e-6;  // tolerance
  SingularRate both_sides_;
  StateRate rate_;
  StagesOn on_ = StagesOn::plain;
  bool near_ = false;             // automatic: the next step begins with its stages on the constraints
  bool probed_ = false;           // whether the start of the run was probed for a singular position
  bool from_both_sides_ = false;  // the first stage's rates are SingularRate's
  int shifts_ = 0;                // of the present step,
  double limit_ = 1;
  struct {
    double h = 0, error = 0;
  } best_;  // and the best of them
};

}  // namespace lockstep
