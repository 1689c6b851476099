// SPDX-License-Identifier: BSD-3-Clause
// Clock: where the steps of a run end, how long they are, and which instants are output. Internal to the step loop.
#pragma once

#include <limits>
#include <vector>

#include <lockstep/step_loop.h>
#include "framework/dynamics/simulate/last_steps.h"

namespace lockstep {

inline constexpr double kNever = std::numeric_limits<double>::infinity();  ///< an instant that does not come

class LOCKSTEP_API Clock {
 public:
  Clock(const System& system, const Integrator& method, const StepLoopOptions& options)
      : system_(system), info_(method.info()), options_(options) {}

  struct Target {
    double t = 0;       ///< where the state is wanted
    double reach = 0;   ///< where the step ends: t, or slightly before it (a law's jump)
    bool jump = false;  ///< a law jumps at t
  };

  /// The end of the run, which has reached t; infinity: single steps. The steps kept are those towards one end.
  void set_end(double end, double t) {
    if (end != t_end_) last_.begin(t);
    t_end_ = end;
  }
  /// A new run from t.
  void start(double t);

  // -- steps
  bool adaptive() const { return info_.adaptive; }
  double advised() const { return advised_; }  ///< length of the next step
  /// The longest first step of a method that begins at t.
  double horizon(double t) const;
  /// The method begins again at t. `guess`: its first step, or 0.
  void begin(double t, double guess);
  /// Fixed steps are counted from here.
  void set_anchor(double t) { anchor_ = t, n_from_anchor_ = 0; }
  /// The nearest of `limit`, `event`, the laws' jumps and, unless they are interpolated, the output times. `largest`: a
  /// step length, by which to look ahead where no end is known.
  Target next_target(double t, double limit, double event, double largest, bool interpolates);
  /// The length of the next step. Throws StepError if it is round-off.
  double step_towards(double t, const Target&, double largest) const;
  /// Counts a step of requested length `asked`.
  void count_step(double asked, const StepReport&);
  /// The last steps; those of the run are added where they are accepted.
  LastSteps& last() { return last_; }
  const LastSteps& last() const { return last_; }
  /// Of a run that has made n steps and reached t, as LastSteps::check.
  void check(double t, long n) const { last_.check({info_.name, info_.adaptive, t, t_end_, n, options_.max_steps}); }
  /// How far apart two equal times about t may be: rounding of the time and of the length of the run, s.
  double same_instant(double t) const;
  /// Whether an instant lies before t by more than that.
  bool is_past(double instant, double t) const { return instant < t - same_instant(t); }

  // -- outputs
  double next_output() const { return output_time(next_output_); }             ///< infinity: none left
  double output_ahead(long n) const { return output_time(next_output_ + n); }  ///< the n-th after the next
  void pass_output() { ++next_output_; }
  /// Whether the state at t is output: every step when no times were requested; else at the requested times, and at the
  /// start of the run unless they are a list.
  bool output_due(double t) const;
  /// Whether the end of the run must still be output, which it is with an output interval.
  bool end_due(double t) const;
  /// The state at t was output.
  void note_output(double t) {
    last_output_ = t;
    if (next_output() == t) pass_output();
  }
  /// The shortest time between requested outputs; infinity: every step is one.
  double shortest_output() const;

  // -- checkpoints
  void save(Snapshot&) const;
  void load(SnapshotReader&);

 private:
  void refresh_breakpoints(double t, double limit, double largest);
  double output_time(long k) const;
  double span() const;

  const System& system_;
  const IntegratorInfo info_;
  const StepLoopOptions& options_;
  double t_start_ = 0, t_end_ = 0;
  double advised_ = 0;  // the method's next step
  double anchor_ = 0;   // fixed steps: the n-th ends at anchor + n step
  long n_from_anchor_ = 0;
  LastSteps last_;
  long next_output_ = 0;
  double last_output_ = -std::numeric_limits<double>::infinity();
  std::vector<double> breakpoints_;
  std::size_t next_breakpoint_ = 0;
  double breakpoints_to_ = -std::numeric_limits<double>::infinity();
};

}  // namespace lockstep
