// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/run_rows.h"

namespace lockstep {

void RunRows::start(const Sample&) {
  n_taken_ = 0;
  rows_.clear();
  if (!goes_on_) csv_.begin();
}

void RunRows::output(const Sample&) {
  csv_.take();
  const Table& table = recorder_.table();
  for (; n_taken_ < table.n_rows(); ++n_taken_) rows_.add(table, n_taken_);
  if (keeps_) return;
  recorder_.drop_rows();
  csv_.table_emptied(), n_taken_ = 0;
}

void RunRows::save(Snapshot& out) const {
  out.put(static_cast<double>(file_.length()));
  out.put_bits(file_.hash());
  rows_.save(out);
}

void RunRows::load(SnapshotReader& in) {
  const long length = in.get_count();
  const std::uint64_t hash = in.get_bits();
  rows_.load(in);
  file_.go_on(length, hash);
}

}  // namespace lockstep
