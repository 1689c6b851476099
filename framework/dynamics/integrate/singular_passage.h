// SingularPassage: how an explicit method passes singular positions, where the rows do not determine the accelerations.
#pragma once

#include <cmath>
#include <vector>

#include <lockstep/stepping.h>
#include "framework/dynamics/integrate/singular_rate.h"

namespace lockstep {

/// The SolveReport::detector below which a position counts as near a singular one; `regular`: Redundancy::regular,
/// small in all positions if bodies differ much in inertia.
LOCKSTEP_API double near_singular_below(double regular);

// Near one its stages are evaluated on the constraints; and always if rows are redundant only there, as in a
// spherical loop of hinges: a little off the constraints they are nearly dependent, and their multipliers grow without limit.
// Where the indicator of the last stages says when the position will be reached, the steps are placed so that it falls
// into the widest gap between the nodes of the method: round-off in the accelerations grows with a high power of the
// nearness. A step whose late stage is ill-conditioned all the same, or whose estimate is spoilt by such a stage, is
// shifted: a slightly different step ends elsewhere.

/// Takes the steps of an explicit method through singular positions.
class LOCKSTEP_API SingularPassage {
 public:
  /// `method`: its name, for messages; it lives as long as the program.
  SingularPassage(StagesWhen when, const char* method) : when_(when), method_(method) {}
  /// Sizes the scratch and forgets the history. It rests in joint coordinates of trees, which have no rows, and, when
  /// automatic, where no loop is closed or the dynamics does not project.
  void begin(const Tableau&, const State&, Dynamics&);
  StagesWhen when() const { return when_; }  ///< when stages are to be evaluated on the constraints
  /// Whether it needs the conditioning of the stages.
  bool active() const { return active_; }
  void set_tolerance(double relative) { relative_ = relative; }  ///< sets the relative tolerance of the method

  // -- a step from y
  void start_step();                          ///< begins a step
  StagesOn stages_on() const { return on_; }  ///< where the stages of this step are evaluated
  /// Evaluates the first stage in `stages`; in a singular position its rates come from both sides of it (SingularRate).
  /// False: it could not be brought onto the constraints. Throws StepError where several motions continue from the
  /// start of a run.
  bool first_stage(Dynamics&, const State& y, Stages& stages);
  /// The step to attempt, s, at most h: with its stages on the constraints a step turns no body by more than 0.5 rad and
  /// keeps its stages away from a singular position ahead.
  double longest(double h);
  /// Whether an attempt came near a singular position and must be repeated with its stages on the constraints, as
  /// stages_on() then says.
  bool enters(const Stages&);
  /// Whether an attempt of this error should be shifted rather than accepted or rejected.
  bool must_shift(const Stages&, double error) const;
  /// The step to attempt instead of h, s; after a dozen of them the best one, with a larger limit of its error.
  double shift(const Stages&, double h, double error);
  /// Errors up to this are accepted, in tolerances.
  double limit() const { return limit_; }
  /// After acceptance: decides where the stages of the next step are evaluated, and reckons when a singular position will
  /// be reached. The next step is as long as this one would have been.
  void finish_step(const Stages&, StepReport&);

  /// First step from y, s, at most `largest`: `guess`, or in a singular position a step that leads out of it.
  double first_step(Dynamics&, const State& y, Stages&, double guess, double largest);
  bool near(const Stages& stages) const;  ///< whether one of these stages is near a singular position

  /// Saves what it knows of the next step.
  void save(Snapshot& out) const {
    out.put(near_ ? 1 : 0), out.put(ahead_), out.put(longest_plain_), out.put(begun_ ? 1 : 0);
    out.put(below_), out.put(on_constraints_ ? 1 : 0);
  }
  /// Takes back what save() wrote.
  void restore(SnapshotReader& in) {
    near_ = in.get() != 0, ahead_ = in.get(), longest_plain_ = in.get(), begun_ = in.get_flag();
    below_ = in.get(), on_constraints_ = in.get_flag();
  }

 private:
  bool ill_conditioned(const Stages&, int stage) const;
  double straddle(double h) const;
  double fastest_turn(const State&);
  double time_to_turn(double angle) const;
  bool find_both_sides(Dynamics&, const State&);

  StagesWhen when_;
  const char* method_;
  bool active_ = false;
  double below_ = 0;        // an indicator below this is near a singular position
  double relative_ = 1e-6;  // tolerance
  SingularRate both_sides_;
  StateRate rate_;
  std::vector<Motion> motions_;  // of states in joint coordinates
  StagesOn on_ = StagesOn::plain;
  bool near_ = false;             // automatic: the next step begins with its stages on the constraints
  bool entered_ = false;          // the present step went onto the constraints
  double longest_plain_ = 0;      // step so far, s
  double rate_of_turn_ = 0;       // at the start of the present step, rad/s
  double ahead_ = HUGE_VAL;       // time until a singular position is reached, s
  double unplaced_ = 0;           // the present step, s, had it not been placed
  std::vector<double> nodes_;     // as parts of the step, ascending
  int inner_ = 0;                 // the stage of the last node before the end of the step,
  int last_ = 0;                  // and one at the end
  bool begun_ = false;            // the start of the run is left
  bool on_constraints_ = false;   // rows are redundant on the constraints only
  bool from_both_sides_ = false;  // the first stage's rates are SingularRate's
  int shifts_ = 0;                // of the present step,
  double limit_ = 1;
  struct {
    double h = 0, error = 0;
  } best_;  // and the best of them
};

}  // namespace lockstep
