// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/record/row_envelope.h"

#include <algorithm>

namespace lockstep {

RowEnvelope::RowEnvelope(const Table& columns, std::size_t most) : width_(columns.n_columns()), most_(most) {
  for (const Column& c : columns.columns()) columns_.add_column(c.name, c.unit);
  kept_.reserve(most_ * width_);
  last_.resize(width_), open_.resize(3 * width_);
  clear();
}

void RowEnvelope::clear() {
  kept_.clear(), path_.clear();
  per_pair_ = path_every_ = 1, n_rows_ = n_open_ = 0;
}

void RowEnvelope::add(const Table& table, std::size_t i) {
  for (std::size_t k = 0; k < width_; ++k) last_[k] = table.columns()[k].values[i];
  ++n_rows_;
  if (per_pair_ == 1) {
    kept_.insert(kept_.end(), last_.begin(), last_.end());
    if (n_kept() < most_) return;
    path_ = kept_;
    thin_path();
    thin();
    return;
  }
  if ((n_rows_ - 1) % path_every_ == 0) {
    path_.insert(path_.end(), last_.begin(), last_.end());
    if (path_.size() == most_ * width_) thin_path();
  }
  for (std::size_t j = n_open_ == 0 ? 0 : 2; j < 3; ++j) std::ranges::copy(last_, &open_[j * width_]);
  take_extremes(open_.data(), 3, open_.data());
  if (++n_open_ < per_pair_) return;
  kept_.insert(kept_.end(), open_.data(), &open_[2 * width_]);
  n_open_ = 0;
  if (n_kept() == most_) thin();
}

// The extremes of each column in n rows, the earlier one in the first row of a pair, which may be the first of the rows.
void RowEnvelope::take_extremes(const double* rows, std::size_t n, double* pair) const {
  for (std::size_t k = 0; k < width_; ++k) {
    const auto at = [&](std::size_t j) { return rows[j * width_ + k]; };
    std::size_t least = 0, most = 0;
    for (std::size_t j = 1; j < n; ++j) {
      if (at(j) < at(least)) least = j;
      if (at(j) > at(most)) most = j;
    }
    const double first = at(std::min(least, most)), second = at(std::max(least, most));
    pair[k] = first, pair[width_ + k] = second;
  }
}

// Every second whole row goes; the first stays.
void RowEnvelope::thin_path() {
  const std::size_t n = (path_.size() / width_ + 1) / 2;
  for (std::size_t i = 1; i < n; ++i) std::copy_n(&path_[2 * i * width_], width_, &path_[i * width_]);
  path_.resize(n * width_);
  path_every_ *= 2;
}

// Every four rows become two.
void RowEnvelope::thin() {
  const std::size_t n = n_kept() / 4;
  for (std::size_t group = 0; group < n; ++group)
    take_extremes(&kept_[4 * group * width_], 4, &kept_[2 * group * width_]);
  kept_.resize(2 * n * width_);
  per_pair_ = per_pair_ == 1 ? 4 : 2 * per_pair_;
}

// A group that is not full shows its extremes too, and ends in the last row.
Table RowEnvelope::table() const {
  Table table = columns_;
  for (std::size_t i = 0; i < n_kept(); ++i) table.add_row({&kept_[i * width_], width_});
  for (std::size_t j = 0; j < 2 && n_open_ > 1; ++j) table.add_row({&open_[j * width_], width_});
  if (n_open_ > 0) table.add_row(last_);
  return table;
}

Table RowEnvelope::path_table() const {
  if (path_every_ == 1) return table();
  Table table = columns_;
  for (std::size_t i = 0; i < path_.size(); i += width_) table.add_row({&path_[i], width_});
  if ((n_rows_ - 1) % path_every_ != 0) table.add_row(last_);
  return table;
}

void RowEnvelope::save(Snapshot& out) const {
  for (const long n : {per_pair_, path_every_, n_rows_, n_open_}) out.put(static_cast<double>(n));
  for (const std::vector<double>* v : {&kept_, &path_, &open_, &last_}) out.put_all(*v);
}

void RowEnvelope::load(SnapshotReader& in) {
  for (long* n : {&per_pair_, &path_every_, &n_rows_, &n_open_}) *n = in.get_count();
  for (std::vector<double>* v : {&kept_, &path_, &open_, &last_}) in.get_all(*v);
}

}  // namespace lockstep
