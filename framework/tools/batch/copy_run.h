// A run of one batch, in lanes or one copy after another. Private to the room.
#pragma once

#include <limits>
#include <vector>

#include "framework/tools/batch/batch.h"
#include "framework/tools/batch/copies.h"
#include "framework/dynamics/integrate/tableau.h"

namespace lockstep::lanes {

/// What one copy has before it: the wanted times, and the jumps of its laws between them.
class Course {
 public:
  void begin(const System&, double t0, std::span<const double> times);
  bool done() const { return next_ == times_.size(); }
  std::size_t next() const { return next_; }
  /// The next place to land on: a wanted time, or a few roundings before a jump.
  double reach() const;
  /// A step of about h from t that does not pass reach(): all of the way, or half of it rather than leave a crumb.
  /// With `equal` the way is cut into equal steps.
  double step(double t, double h, bool equal) const;
  /// Having arrived at reach(): where the time stands now. Wanted times are told by `wanted`.
  double arrive(bool& wanted);

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

/// From `state` to the end of the course by the ordinary Dynamics and integrator, or until it fails. `h`: first step;
/// 0: the method's own guess.
void run_alone(System&, int copy, State state, Course course, double h, const RunTask&, CopyReport&);

/// All copies of a batch in lanes; those that get into difficulty are finished by run_alone.
void run_lanes(Batch&, std::span<const State> starts, const RunTask&, std::span<CopyReport>);

}  // namespace lockstep::lanes
