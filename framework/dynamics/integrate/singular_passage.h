// SPDX-License-Identifier: BSD-3-Clause
// SingularPassage: how an explicit method passes singular positions, where the rows do not determine the accelerations.
#pragma once

#include <cmath>
#include <vector>

#include <lockstep/author/stepping.h>
#include "framework/dynamics/evaluate/singular_rate.h"

namespace lockstep {

// One policy. Near a singular position the stages are evaluated on the constraints, where the accelerations are a
// smooth function of the motion; and always if rows are redundant only there, as in a spherical loop of hinges. At
// the distance e, rad, rounding leaves eps/e^3 of the accelerations, and the indicator is e^2 at most. If that may be
// more than the tolerance, SingularRate looks at both sides: closer than half of its d, stages and noisy ends of
// steps are its limits. No step can be more accurate than its stages: an error that they explain and that a shorter
// step has too is accepted.

/// Takes the steps of an explicit method through singular positions.
class LOCKSTEP_API SingularPassage {
 public:
  /// `method`: its name, for messages; it lives as long as the program.
  SingularPassage(StagesWhen when, const char* method) : when_(when), method_(method) {}
  /// Sizes the scratch and forgets the history. It rests in joint coordinates of trees, which have no rows, and, when
  /// automatic, if no loop is closed or the dynamics does not project.
  void begin(const Tableau&, const State&, Dynamics&);
  StagesWhen when() const { return when_; }                      ///< when stages are to be evaluated on the constraints
  bool active() const { return active_; }                        ///< whether it needs the conditioning of the stages
  void set_tolerance(double relative) { relative_ = relative; }  ///< sets the relative tolerance of the method

  void start_step();                          ///< begins a step
  StagesOn stages_on() const { return on_; }  ///< where the stages of this step are evaluated
  /// Evaluates the stages first ... last - 1 of a step of h, s, from y. False: one could not be brought onto the
  /// constraints. Throws StepError if several motions continue from the start of a run.
  bool evaluate(Dynamics&, const State& y, double h, int first, int last, Stages&);
  /// The step to attempt, s, at most h: on the constraints a step rotates no body by more than 0.5 rad.
  double longest(double h) const;
  /// Whether an attempt came near a singular position and must be repeated with its stages on the constraints, as
  /// stages_on() then reports.
  bool enters();
  /// Whether an attempt of h, s, with this error, in tolerances, is accepted: also with what its stages leave
  /// uncertain, if a longer attempt of this step had such an error too.
  bool accepts(double h, double error);
  /// Puts the end of the step on the constraints.
  ProjectReport land(Dynamics&, State& end);
  /// After acceptance: decides where the stages of the next step are evaluated.
  void finish_step(StepReport&);
  bool near() const { return active_ && seen_.indicator < below_; }  ///< whether a stage is near a singular position

  /// Saves what it knows of the next step.
  void save(Snapshot& out) const {
    out.put(near_ ? 1 : 0), out.put(begun_ ? 1 : 0), out.put(below_), out.put(on_constraints_ ? 1 : 0);
  }
  /// Takes back what save() wrote.
  void restore(SnapshotReader& in) {
    near_ = in.get_flag(), begun_ = in.get_flag(), below_ = in.get(), on_constraints_ = in.get_flag();
  }

 private:
  struct Seen {
    double indicator = HUGE_VAL;  // smallest,
    double accuracy = 0;          // what rates have at least, relative,
    bool limit = false;           // and whether the last one is a limit
  };
  using Sides = SingularRate::Sides;
  bool evaluate(Dynamics&, const State& y, double h, int i, Stages&);
  void ask(Dynamics&, const State&);

  StagesWhen when_;
  const char* method_;
  bool active_ = false;
  bool on_constraints_ = false;  // rows are redundant on the constraints only
  double below_ = 0;             // an indicator below this is near a singular position; 0: not known yet
  double relative_ = 1e-6;       // tolerance
  std::vector<Weights> a_;
  SingularRate both_sides_;
  StateRate rate_;
  State stage_;
  std::vector<Motion> motions_;
  StagesOn on_ = StagesOn::plain;
  bool near_ = false;        // automatic: the next step begins with its stages on the constraints
  bool begun_ = false;       // the start of the run is left
  double rate_of_turn_ = 0;  // at the start of the present step, rad/s
  double longer_ = 0;        // the longest attempt of the present step whose error its stages explain, s
  Seen seen_, first_;        // by the present attempt, and by its first stage
};

}  // namespace lockstep
