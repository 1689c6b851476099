// SPDX-License-Identifier: BSD-3-Clause
// RunRows: writes the rows of a run to its file as they come, and to an envelope in memory.
#pragma once

#include <string>

#include "framework/tools/program/growing_file.h"
#include "framework/tools/record/csv_lines.h"
#include "framework/tools/record/row_envelope.h"

namespace lockstep {

/// Add it to the run after the recorder. It writes the file every second; what it appended last is left to write() or
/// commit().
class RunRows final : public Observer {
 public:
  /// `keeps`: the recorder keeps all its rows, for later readers; `units`: in the header.
  RunRows(GrowingFile& file, Recorder& recorder, bool keeps, bool units)
      : file_(file), recorder_(recorder), rows_(recorder.table()), keeps_(keeps), units_(units) {}

  /// The run continues from a checkpoint: the file is continued.
  void go_on() { goes_on_ = true; }
  const RowEnvelope& rows() const { return rows_; }

  void start(const Sample&) override {
    n_taken_ = 0;
    rows_.clear();
    if (goes_on_) return;
    file_.clear();
    line_.clear();
    append_csv_header(line_, recorder_.table(), units_);
    file_.append(line_);
  }
  void output(const Sample&) override {
    const Table& table = recorder_.table();
    for (; n_taken_ < table.n_rows(); ++n_taken_) {
      line_.clear();
      append_csv_row(line_, table, n_taken_);
      file_.append(line_);
      rows_.add(table, n_taken_);
    }
    file_.write_if_due();
    if (!keeps_) recorder_.drop_rows(), n_taken_ = 0;
  }
  void finish(const Sample& s) override { output(s); }
  /// All rows must have been written (GrowingFile::sync).
  void save(Snapshot& out) const override {
    out.put(static_cast<double>(file_.length()));
    out.put_bits(file_.hash());
    rows_.save(out);
  }
  void load(SnapshotReader& in) override {
    const long length = in.get_count();
    const std::uint64_t hash = in.get_bits();
    rows_.load(in);
    file_.go_on(length, hash);
  }

 private:
  GrowingFile& file_;
  Recorder& recorder_;
  RowEnvelope rows_;
  std::size_t n_taken_ = 0;  // of the recorder's rows
  const bool keeps_, units_;
  bool goes_on_ = false;
  std::string line_;  // scratch
};

}  // namespace lockstep
