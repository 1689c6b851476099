// Rows: where links write what they constrain, and where solvers read it. Neither knows the other.
//
// One block a link: C, Ct, Qhat (m each), then the jacobian of each moving slot it touches (m x 6, row after row).
// Links of one group (same type, same pattern) follow one another, so that a group is gathered by one call.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <vector>

#include "framework/math/types.h"
#include "framework/model/body.h"

namespace lockstep {

/// What a row measures: metres (force multiplier), half turns (moment multiplier), or a function's own value.
enum class RowKind : unsigned char { translation, rotation, function };

inline constexpr int kMaxSlots = 4;  ///< bodies that one link may touch
inline constexpr int kMaxRows = 8;   ///< rows that one link may have

/// Moving slots that a link touches, ground left out, a shared slot once.
struct SlotList {
  std::array<int, kMaxSlots> slot{};
  int n = 0;
  SlotList() = default;
  void add(int k) {
    if (k == kGround || position(k) >= 0) return;
    assert(n < kMaxSlots);
    slot[static_cast<std::size_t>(n++)] = k;
  }
  /// Where slot k stands in the list; -1 for the ground.
  int position(int k) const {
    for (int i = 0; i < n; ++i)
      if (slot[static_cast<std::size_t>(i)] == k) return i;
    return -1;
  }
  int operator[](int i) const { return slot[static_cast<std::size_t>(i)]; }
};

/// The rows of one link, to be written.
class RowBlock {
 public:
  RowBlock(double* base, int m, int n) : p_(base), m_(m), n_(n) {}
  static std::size_t size(int m, int n) { return static_cast<std::size_t>(m * (3 + 6 * n)); }

  int rows() const { return m_; }
  int slots() const { return n_; }
  double& C(int k) const { return p_[k]; }
  double& Ct(int k) const { return p_[m_ + k]; }
  double& Qhat(int k) const { return p_[2 * m_ + k]; }
  /// Row k on the link's i-th slot: 6 numbers, v (world) then w (slot axes).
  double* J(int i, int k) const { return p_ + 3 * m_ + 6 * (m_ * i + k); }

  /// Row k on slot number i; i < 0 (a grounded side) is ignored.
  template <class V, class W>
  void set(int i, int k, const V& v, const W& w) const {
    if (i < 0) return;
    double* r = J(i, k);
    r[0] = v[0], r[1] = v[1], r[2] = v[2], r[3] = w[0], r[4] = w[1], r[5] = w[2];
  }
  template <class V, class W>
  void add(int i, int k, const V& v, const W& w) const {
    if (i < 0) return;
    double* r = J(i, k);
    r[0] += v[0], r[1] += v[1], r[2] += v[2], r[3] += w[0], r[4] += w[1], r[5] += w[2];
  }

 private:
  double* p_;
  int m_, n_;
};

/// The rows of a group, link after link.
class RowSpan {
 public:
  RowSpan(double* base, int m, int n) : base_(base), m_(m), n_(n) {}
  RowBlock lane(std::size_t k) const { return {base_ + k * RowBlock::size(m_, n_), m_, n_}; }

 private:
  double* base_;
  int m_, n_;
};

/// Where the rows of one active link stand.
struct RowEntry {
  int link = 0;       ///< number of the link in the system
  int first_row = 0;  ///< its first row among all active ones
  int m = 0;          ///< its rows
  SlotList slots;
  std::size_t offset = 0;  ///< of its block in the table
  std::array<RowKind, kMaxRows> kind{};
};

/// Neighbours in the table that one call gathers.
struct RowRun {
  int first_entry = 0, n = 0;
  int first_link = 0;  ///< where the run begins in the system's order of links
};

/// All active rows of the system.
class RowTable {
 public:
  std::vector<RowEntry> entries;  ///< in the order of the table, group after group
  std::vector<RowRun> runs;
  std::vector<int> entry_of_link;  ///< -1: not active
  int n_rows = 0;

  /// Lays the entries out one after another; memory only grows.
  void lay_out() {
    std::size_t at = 0;
    n_rows = 0;
    for (RowEntry& e : entries) {
      e.first_row = n_rows;
      e.offset = at;
      n_rows += e.m;
      at += RowBlock::size(e.m, e.slots.n);
    }
    if (data_.size() < at) data_.resize(at);
  }
  RowBlock block(const RowEntry& e) const { return {data_.data() + e.offset, e.m, e.slots.n}; }
  RowSpan span(const RowEntry& first) const { return {data_.data() + first.offset, first.m, first.slots.n}; }

 private:
  mutable std::vector<double> data_;
};

}  // namespace lockstep
