// What makes the result of a run doubtful though it went through: tolerances that were not reached, recorded reactions that
// rounding decides.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <lockstep/export.h>
#include <lockstep/step_loop.h>

namespace lockstep {

/// Watches what the method says of its steps, and the conditioning of the instants that are recorded.
class LOCKSTEP_API Doubts final : public Observer {
 public:
  static constexpr std::size_t kNamed = 5;  ///< instants that are kept

  /// `reactions`: some are recorded; `tolerance`: of the method, relative, 0 for fixed steps.
  Doubts(bool reactions, double tolerance) : reactions_(reactions), tolerance_(tolerance) {}

  void start(const Sample&) override;
  void step(const Sample&) override;
  void output(const Sample&) override;
  void save(Snapshot&) const override;
  void load(SnapshotReader&) override;

  long beyond() const { return beyond_; }            ///< steps whose error is above the tolerance
  double largest_error() const { return largest_; }  ///< of them, in tolerances
  double first() const { return first_; }            ///< the end of the first of them, s
  /// How many recorded instants lie beside a singular position, so that reactions may be off by more than a hundredth.
  long n_uncertain() const { return n_uncertain_; }
  /// The first of them, kNamed at most, s.
  const std::vector<double>& uncertain() const { return uncertain_; }

 private:
  bool reactions_, loops_ = false;
  double tolerance_;
  long beyond_ = 0, n_uncertain_ = 0;
  double largest_ = 0, first_ = 0;
  std::vector<double> uncertain_;
};

}  // namespace lockstep
