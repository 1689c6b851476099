// SPDX-License-Identifier: BSD-3-Clause
// RunRows: writes the rows of a run to its file as they come, and to an envelope in memory.
#pragma once

#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/row_envelope.h"

namespace lockstep {

/// Add it to the run after the recorder.
class RunRows final : public Observer {
 public:
  /// `keeps`: the recorder keeps all its rows, for later readers; `units`: in the header.
  RunRows(GrowingFile& file, Recorder& recorder, bool keeps, bool units)
      : file_(file), recorder_(recorder), csv_(file, recorder.table(), units), rows_(recorder.table()), keeps_(keeps) {}

  /// The run continues from a checkpoint: the file is continued.
  void go_on() { goes_on_ = true; }
  const RowEnvelope& rows() const { return rows_; }

  void start(const Sample&) override;
  void output(const Sample&) override;
  void finish(const Sample& s) override { output(s); }
  /// All rows must have been written (GrowingFile::sync).
  void save(Snapshot&) const override;
  void load(SnapshotReader&) override;

 private:
  GrowingFile& file_;
  Recorder& recorder_;
  GrowingCsv csv_;
  RowEnvelope rows_;
  std::size_t n_taken_ = 0;  // of the recorder's rows
  const bool keeps_;
  bool goes_on_ = false;
};

}  // namespace lockstep
