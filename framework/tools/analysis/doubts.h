// What makes the result of a run doubtful though it went through: tolerances that were not reached, recorded reactions that
// rounding decides.
#pragma once

#include <string>
#include <vector>

#include <lockstep/export.h>
#include <lockstep/step_loop.h>

namespace lockstep {

/// Watches what the method says of its steps, and the conditioning of the instants that are recorded.
class LOCKSTEP_API Doubts final : public Observer {
 public:
  /// `reactions`: some are recorded; `tolerance`: of the method, relative, 0 for fixed steps.
  Doubts(bool reactions, double tolerance) : reactions_(reactions), tolerance_(tolerance) {}

  void start(const Sample&) override;
  void step(const Sample&) override;
  void output(const Sample&) override;
  void save(Snapshot&) const override;
  void load(const Snapshot&) override;

  long beyond() const { return beyond_; }            ///< steps whose error is above the tolerance
  double largest_error() const { return largest_; }  ///< of them, in tolerances
  double first() const { return first_; }            ///< the end of the first of them, s
  /// Recorded instants, s, beside a singular position, whose reactions may be off by more than a hundredth.
  const std::vector<double>& uncertain() const { return uncertain_; }

 private:
  bool reactions_, loops_ = false;
  double tolerance_;
  long beyond_ = 0;
  double largest_ = 0, first_ = 0;
  std::vector<double> uncertain_;
};

}  // namespace lockstep
