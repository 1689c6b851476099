// SPDX-License-Identifier: BSD-3-Clause
// Rows of a table in addition to its outputs: at jumps.
#pragma once

#include <functional>
#include <utility>

#include <lockstep/recorder.h>

namespace lockstep {

/// Adds rows just before and just after events, impacts and jumps of laws: "at_jumps" of "run". Add it to the run after the
/// recorder.
class LOCKSTEP_API RowsAtJumps : public Observer {
 public:
  /// `add`: adds a row of this state to `rows`. If the last of them is of the instant of the jump, as at an output, it is
  /// the one before.
  RowsAtJumps(std::function<void(const Sample&)> add, const Recorder& rows) : add_(std::move(add)), rows_(rows) {}
  void before_jump(const Sample& sample) override {
    acted_ = sample.state.t;
    if (rows_.last_instant() != acted_) add_(sample);
  }
  void jumped(const Sample& sample) override {
    if (sample.state.t == acted_) add_(sample);
  }
  bool keeps_rows() const override { return true; }
  void save(Snapshot& out) const override { out.put(acted_); }
  void load(SnapshotReader& in) override { acted_ = in.get(); }

 private:
  std::function<void(const Sample&)> add_;
  const Recorder& rows_;
  double acted_ = -1;  // when something acted last, s
};

}  // namespace lockstep
