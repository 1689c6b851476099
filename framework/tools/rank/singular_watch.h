// SPDX-License-Identifier: BSD-3-Clause
// SingularWatch: the singular configurations that a run passes without noticing.
#pragma once

#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/step_loop.h>

namespace lockstep {

/// A singular configuration that a run passed.
struct PassedPosition {
  double t = 0;                    ///< s
  double indicator = 0;            ///< the singularity indicator there (SolveReport::detector)
  std::vector<std::string> links;  ///< whose rows depend on one another there alone; none if there are too many rows
};

/// Watches the steps whose stages are evaluated as they are, and finds the singular configurations between them. It
/// looks at the singularity indicator whenever a body has turned by 0.02 rad, with a solver of its own. Where the
/// indicator has a minimum that lies nearer to a singular configuration than the stages of a step to one another, they
/// did not see that position.
class LOCKSTEP_API SingularWatch final : public Observer {
 public:
  /// The system must outlive it.
  explicit SingularWatch(System&);

  /// Whether a run needs it: loops, rows that are in force as such, and a method that does not care for singular
  /// positions itself.
  static bool is_needed(const Dynamics&, const State&, const IntegratorInfo&);

  void start(const Sample&) override;
  void step(const Sample&) override;
  void jumped(const Sample&) override;
  void save(Snapshot&) const override;
  void load(SnapshotReader&) override;

  static constexpr std::size_t kKept = 64;  ///< positions that are kept
  /// The first of them, at most kKept.
  const std::vector<PassedPosition>& passed() const { return passed_; }
  long n_passed() const { return n_passed_; }  ///< how many there were

 private:
  struct Look {
    State state;
    double indicator = -1;  ///< -1: none
    double rate = 0;        ///< of the body that turns fastest, rad/s
    double turn = 0;        ///< of the step that led here, rad
  };

  Look look_at(const Sample&, double turn) const;
  double indicator(const State&);
  void look(Look now);
  void find_between(const Look& before, const Look& lowest, const Look& after);
  void forget();

  System& system_;
  Dynamics eye_;  // sees states that the run does not
  Look before_, last_, regular_;
  double turned_ = 0;  // since the last look, rad
  std::vector<PassedPosition> passed_;
  long n_passed_ = 0;
};

/// Of the first of n positions that a run passed by this method; `projects`: its stabilisation is "project".
LOCKSTEP_API Finding finding_of(const std::vector<PassedPosition>& first, long n, const IntegratorInfo&, bool projects);

}  // namespace lockstep
