// SPDX-License-Identifier: BSD-3-Clause
// Additional rows between the outputs of a run, for smooth pictures.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include <lockstep/recorder.h>
#include "framework/tools/scene_run/rows_at_jumps.h"

namespace lockstep {

/// The rows that a picture needs in addition to those of the table: on a grid within steps, by dense output, or at the
/// ends of steps of a method without it; before and after jumps.
class PictureRows final : public RowsAtJumps {
 public:
  /// `own`: a recorder of the columns that are drawn, which `rows` has, too. `spacing`: of the rows, s; infinity: at
  /// jumps only.
  PictureRows(std::unique_ptr<Recorder> own, const Recorder& rows, double spacing);
  void start(const Sample&) override;
  void inside(const InsideStep&) override;
  void step(const Sample&) override;
  void jumped(const Sample&) override;
  bool keeps_rows() const override { return false; }
  void save(Snapshot&) const override;
  void load(SnapshotReader&) override;

  /// With the rows of the run, `main`, in the order of time: the columns that are drawn.
  Table together(const Table& main) const;
  /// Whether rows within steps were requested and the method has no dense output: curves join the ends of its steps.
  bool joins_steps() const { return std::isfinite(spacing_) && n_between_ == 0 && n_steps_ > 0; }

 private:
  bool add(const Sample&, bool of_jump);
  std::unique_ptr<Recorder> own_;
  double spacing_, last_ = 0;
  long n_between_ = 0, n_steps_ = 0;
  std::vector<bool> of_jump_;  // by row of own_
};

/// The interval between rows of a picture, s: about 600 over the run, or infinity if the outputs are as dense.
double picture_spacing(const StepLoopOptions&, double until);

}  // namespace lockstep
