// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/record/row_envelope.h"

#include <algorithm>

namespace lockstep {

RowEnvelope::RowEnvelope(const Table& columns, std::size_t most) : width_(columns.n_columns()), most_(most) {
  for (const Column& c : columns.columns()) columns_.add_column(c.name, c.unit);
  kept_.reserve(most_ * width_);
  for (std::vector<double>* v : {&least_, &most_of_, &last_}) v->resize(width_);
  for (std::vector<long>* v : {&least_at_, &most_at_}) v->resize(width_);
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
  for (std::size_t k = 0; k < width_; ++k) {
    if (n_open_ == 0 || last_[k] < least_[k]) least_[k] = last_[k], least_at_[k] = n_open_;
    if (n_open_ == 0 || last_[k] > most_of_[k]) most_of_[k] = last_[k], most_at_[k] = n_open_;
  }
  if (++n_open_ < per_pair_) return;
  for (const bool second : {false, true}) {
    const std::vector<double> row = open_row(second);
    kept_.insert(kept_.end(), row.begin(), row.end());
  }
  n_open_ = 0;
  if (n_kept() == most_) thin();
}

// The extremes of the open group, the earlier of each column in the first row.
std::vector<double> RowEnvelope::open_row(bool second) const {
  std::vector<double> row(width_);
  for (std::size_t k = 0; k < width_; ++k) row[k] = (least_at_[k] <= most_at_[k]) == second ? most_of_[k] : least_[k];
  return row;
}

// Every second whole row goes; the first stays.
void RowEnvelope::thin_path() {
  const std::size_t n = (path_.size() / width_ + 1) / 2;
  for (std::size_t i = 1; i < n; ++i) std::copy_n(&path_[2 * i * width_], width_, &path_[i * width_]);
  path_.resize(n * width_);
  path_every_ *= 2;
}

// Every four rows become two: the extremes of each column, the earlier one first.
void RowEnvelope::thin() {
  const std::size_t n = n_kept() / 4;
  for (std::size_t group = 0; group < n; ++group)
    for (std::size_t k = 0; k < width_; ++k) {
      const double* from = &kept_[4 * group * width_ + k];
      std::size_t least = 0, most = 0;
      for (std::size_t j = 1; j < 4; ++j) {
        if (from[j * width_] < from[least * width_]) least = j;
        if (from[j * width_] > from[most * width_]) most = j;
      }
      const double first = from[std::min(least, most) * width_], second = from[std::max(least, most) * width_];
      kept_[2 * group * width_ + k] = first, kept_[(2 * group + 1) * width_ + k] = second;
    }
  kept_.resize(2 * n * width_);
  per_pair_ = per_pair_ == 1 ? 4 : 2 * per_pair_;
}

// A group that is not full shows its extremes too, and ends in the last row.
Table RowEnvelope::table() const {
  Table table = columns_;
  for (std::size_t i = 0; i < n_kept(); ++i) table.add_row({&kept_[i * width_], width_});
  if (n_open_ > 1)
    for (const bool second : {false, true}) table.add_row(open_row(second));
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
  for (const std::vector<double>* v : {&kept_, &path_, &least_, &most_of_, &last_}) out.put_all(*v);
  for (const std::vector<long>* v : {&least_at_, &most_at_}) out.put_all(*v);
}

void RowEnvelope::load(SnapshotReader& in) {
  for (long* n : {&per_pair_, &path_every_, &n_rows_, &n_open_}) *n = in.get_count();
  for (std::vector<double>* v : {&kept_, &path_, &least_, &most_of_, &last_}) in.get_all(*v);
  for (std::vector<long>* v : {&least_at_, &most_at_}) in.get_all(*v);
}

}  // namespace lockstep
