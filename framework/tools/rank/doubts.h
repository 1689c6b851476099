// SPDX-License-Identifier: BSD-3-Clause
// What makes the result of a run doubtful though it went through: a tolerance that was not reached, recorded reactions
// that rounding decides.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/scene.h>
#include <lockstep/step_loop.h>

namespace lockstep {

/// Watches the step reports of the method, and the certainty of recorded reactions near a singular configuration.
class LOCKSTEP_API Doubts final : public Observer {
 public:
  static constexpr std::size_t kNamed = 5;  ///< times that are kept

  /// `reactions`: some are recorded; `tolerance`: of the method, relative, 0 for fixed steps.
  Doubts(bool reactions, double tolerance) : reactions_(reactions), tolerance_(tolerance) {}

  void start(const Sample&) override;
  void step(const Sample&) override;
  void output(const Sample&) override;
  void save(Snapshot&) const override;
  void load(SnapshotReader&) override;

  /// Of a run of so many steps to the time t, s.
  std::vector<Finding> findings(long steps, double t) const;

 private:
  bool reactions_, loops_ = false;
  double tolerance_, begun_ = 0;
  UnmetTolerance unmet_;
  long n_uncertain_ = 0;           // times near a singular configuration: errors of reactions above 1 %
  std::vector<double> uncertain_;  // the first of those times, kNamed at most, s
};

/// "0.51, 1.02, 1.53, ... s": the first of n times.
LOCKSTEP_API std::string times_of(const std::vector<double>& first, std::size_t n);

/// "A, B and C", or the first of them "and 7 more", if there are more than these.
LOCKSTEP_API std::string first_of(const std::vector<std::string>& names, std::size_t most = 24);

/// Constraints "A.x", "A.y" and "B.e1", grouped: "A and C (each x y); B (e1)".
LOCKSTEP_API std::string by_joint(const std::vector<std::string>& constraints);

/// Whether some of these channels depend on reactions, by their names.
LOCKSTEP_API bool are_of_reactions(const std::vector<ChannelRequest>&);
/// The columns of those that hold reactions which are not unique.
LOCKSTEP_API std::vector<std::string> columns_not_unique(const std::vector<ChannelRequest>&, const UniquenessReport&);

}  // namespace lockstep
