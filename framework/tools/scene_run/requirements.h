// SPDX-License-Identifier: BSD-3-Clause
// Requirements: the conditions "require" of a scene, over a run.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <lockstep/recorder.h>
#include <lockstep/scene.h>

namespace lockstep {

/// By how much the conditions of a scene hold: an observer of their extremes, which keeps no rows, and of the instant at
/// which each fails first.
class LOCKSTEP_API Requirements final : public Recorder {
 public:
  explicit Requirements(Mechanism&);
  void start(const Sample& s) override { failed_.assign(margins_.size(), HUGE_VAL), Recorder::start(s); }
  void inside(const InsideStep&) override;
  void save(Snapshot& out) const override { Recorder::save(out), out.put_all(failed_); }
  void load(SnapshotReader& in) override { Recorder::load(in), in.get_all(failed_); }
  /// Whether the k-th one held; lengths to round-off of the size of the mechanism.
  bool held(std::size_t k) const;
  /// When the k-th one failed first, s, if it did.
  double failed(std::size_t k) const { return std::min(failed_[k], ranges()[k].t_least); }

 private:
  System& system_;
  std::vector<Channel> margins_;
  std::vector<double> failed_;
};

/// Those of a scene; null without conditions. Make them before the StepLoop, as the recorder. Throws SceneError with the
/// place in the file of an invalid one.
LOCKSTEP_API std::unique_ptr<Requirements> make_requirements(Mechanism&);

/// Those that did not hold in a run, with the first and the worst instant; or at rest, without.
LOCKSTEP_API std::vector<Finding> broken_requirements(const Mechanism&, const Requirements*, bool at_rest = false);

}  // namespace lockstep
