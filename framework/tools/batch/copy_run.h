// A run of one batch, in lanes or one copy after another. Private to the room.
#pragma once

#include <limits>
#include <vector>

#include <lockstep/stepping.h>
#include "framework/tools/batch/batch.h"
#include <lockstep/batch.h>

namespace lockstep::lanes {

/// Where the steps of one copy end: its output times, and the jumps of its laws between them.
class OutputSchedule {
 public:
  void begin(const System&, double t0, std::span<const double> times);
  bool done() const { return next_ == times_.size(); }
  std::size_t next() const { return next_; }
  /// The next instant at which a step ends: an output time, or a few roundings before a jump.
  double reach() const;
  /// A step of about h from t that does not pass reach(), by step_within(). With `equal` the way is cut into equal
  /// steps.
  double step(double t, double h, bool equal) const;
  /// Whether a step of h from t ends at reach().
  bool lands(double t, double h) const;
  /// From reach() on: the time now. `output`: it is an output time, of index next() - 1.
  double arrive(bool& output);

 private:
  bool jump_first() const;
  std::span<const double> times_;
  std::vector<double> jumps_;
  std::size_t next_ = 0, next_jump_ = 0;
};

struct RunTask {
  const CopiesOptions& options;
  const EmbeddedScheme& scheme;
  const std::function<std::unique_ptr<Integrator>()>& make_integrator;
  std::span<const double> times;
  const Copies::Output& output;
};

/// From `state` to the end of the schedule by the ordinary Dynamics and integrator, or until it fails. `h`: first step;
/// 0: the method's own guess.
void run_alone(System&, int copy, State state, OutputSchedule schedule, double h, const RunTask&, CopyReport&);

/// All copies of a batch in lanes; those that get into difficulty are finished by run_alone.
void run_lanes(Batch&, std::span<const State> starts, const RunTask&, std::span<CopyReport>);

}  // namespace lockstep::lanes
