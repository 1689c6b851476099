// SPDX-License-Identifier: BSD-3-Clause
// The run of one batch, in lanes or one copy after another. Private to the room.
#pragma once

#include <exception>
#include <vector>

#include <lockstep/author/stepping.h>
#include <lockstep/batch.h>
#include "framework/dynamics/simulate/last_steps.h"
#include "framework/tools/batch/batch.h"

namespace lockstep::lanes {

/// The instants at which steps of one copy end: its output times, and the jumps of its laws between them.
class OutputSchedule {
 public:
  void begin(const System&, double t0, std::span<const double> times);
  bool done() const { return next_ == times_.size(); }
  double end() const { return times_.back(); }
  std::size_t next() const { return next_; }
  /// The next instant at which a step ends: an output time, or just before a jump (before_jump). May be passed already
  /// where a jump follows an output closely.
  double reach() const;
  /// A step of about h from t, by step_within(), that does not pass reach(). With `equal`, the interval is divided into
  /// equal steps.
  double step(double t, double h, bool equal) const;
  /// Whether a step of h from t ends at reach().
  bool lands(double t, double h) const;
  /// Advances past reach() and returns its time. `output`: it is an output time, of index next() - 1.
  double arrive(bool& output);

 private:
  bool jump_first() const;
  std::span<const double> times_;
  std::vector<double> jumps_;
  std::size_t next_ = 0, next_jump_ = 0;
  double span_ = 0;  // of the run, s
};

struct CallerThrew {
  std::exception_ptr what;
};

struct RunTask {
  const CopiesOptions& options;
  const EmbeddedScheme& scheme;
  bool watches;  ///< a copy near a singular position leaves the lanes
  const std::function<std::unique_ptr<Integrator>()>& make_integrator;
  std::span<const double> times;
  const Copies::Output& output;
  const Copies::Step& step;
  const Copies::GoOn& go_on;

  /// Of a copy by itself, in joint coordinates.
  Dynamics dynamics_of(System&) const;
  /// What the caller's own functions throw leaves the run as CallerThrew, which is no failure of a copy.
  void tell(int copy, std::size_t time, const State&) const;
  void tell_step(int copy, const State&, bool jumped) const;
  /// Throws StepError if the run is to be broken off.
  void go_on_from(double t) const;
};

/// Takes a state from the near side of the jump of a law to its instant t, in the slots' own coordinates: velocities that
/// jump are projected, as StepLoop does. Throws AssemblyError if positions jump, and what the laws throw.
void pass_jump(Dynamics&, State&, double t);

/// LastSteps::check of a copy that has made n steps and reached t.
void check_length(const LastSteps&, const RunTask&, double end, double t, long n);

/// Runs a copy from `state` through the times from the next one on by StepLoop, whose steps end at each of them, or until
/// it fails. The state may violate the constraints by start_limit (StepLoopOptions).
void run_alone(System&, int copy, State state, std::size_t next, double start_limit, const RunTask&, CopyReport&);

}  // namespace lockstep::lanes
