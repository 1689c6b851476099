// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/scene_run/rows_at_jumps.h"

#include <limits>
#include <utility>

namespace lockstep {

RowsAtJumps::RowsAtJumps(std::function<void(const Sample&)> add, const Recorder& rows)
    : add_(std::move(add)), rows_(rows) {}

double RowsAtJumps::spacing() const { return std::numeric_limits<double>::infinity(); }

void RowsAtJumps::before_jump(const Sample& sample) {
  acted_ = sample.state.t;
  if (rows_.last_instant() != acted_) add_(sample);
}

void RowsAtJumps::jumped(const Sample& sample) {
  if (sample.state.t == acted_) add_(sample);
}

}  // namespace lockstep
