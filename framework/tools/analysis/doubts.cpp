#include "framework/tools/analysis/doubts.h"

#include <algorithm>
#include <cmath>

#include "framework/dynamics/solvers/graph.h"

namespace lockstep {

namespace {

constexpr double kJust = 1 + 1e-6;   // an error of 1 is met
constexpr double kUncertain = 1e-2;  // of a reaction
constexpr double kGrowth = 5;        // measured: an error of the motion becomes this, over the indicator, of a reaction
constexpr double kFixed = 1e-9;      // error of the motion for a method that promises none: that of its projection,
constexpr double kLeastError = 1e-13;  // and of one that promises more than rounding allows

}  // namespace

void Doubts::start(const Sample& sample) {
  loops_ = has_loops(sample.system(), sample.state.modes);
  beyond_ = n_uncertain_ = 0, largest_ = first_ = 0;
  uncertain_.clear();
}

void Doubts::save(Snapshot& out) const {
  out.put(static_cast<double>(beyond_)), out.put(largest_), out.put(first_);
  out.put(static_cast<double>(n_uncertain_));
  out.put_all(uncertain_);
}

void Doubts::load(SnapshotReader& in) {
  beyond_ = in.get_count(), largest_ = in.get(), first_ = in.get();
  n_uncertain_ = in.get_count();
  in.get_all(uncertain_);
}

void Doubts::step(const Sample& sample) {
  if (!(sample.report.error > kJust)) return;
  if (beyond_++ == 0) first_ = sample.state.t;
  largest_ = std::max(largest_, sample.report.error);
}

// Beside a singular position, at the distance theta, an error of the motion appears in the extra direction divided by
// theta, and in what its velocity asks of the rows by theta once more; the indicator falls as theta^2. At a residual the
// rows themselves were not met.
void Doubts::output(const Sample& sample) {
  if (!reactions_ || !loops_ || (sample.state.coordinates && !sample.state.coordinates->has_rows())) return;
  const Solution& solution = sample.values();
  SolveReport report = solution.report;
  solution.factor.complete(report);
  const double error = tolerance_ > 0 ? std::max(tolerance_, kLeastError) : kFixed;
  if (!(std::max(kGrowth * error, report.residual) > kUncertain * report.detector)) return;
  ++n_uncertain_;
  if (uncertain_.size() < kNamed) uncertain_.push_back(sample.state.t);
}

}  // namespace lockstep
