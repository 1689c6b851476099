// Rows: where links write what they constrain, and where solvers read it. Neither knows the other.
//
// One block a link: C, Ct, Qhat (m each, in the link's own axes), then the jacobian of each moving slot it touches,
// column after column, every column padded to a pack. Links of one group (same type, same pattern) follow one another,
// so that a group is gathered by one call.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <vector>

#include "framework/math/pack.h"
#include "framework/math/types.h"
#include "framework/model/body.h"
#include "framework/support/aligned.h"

namespace lockstep {

/// What a row measures: metres (force multiplier), half turns (moment multiplier), or a function's own value.
enum class RowKind : unsigned char { translation, rotation, function };

inline constexpr int kMaxSlots = 4;  ///< bodies that one link may touch
inline constexpr int kMaxRows = 8;   ///< rows that one link may have

/// How the jacobian of a link is kept.
///   dense   any rows: 6 columns a slot, v (world) then w (slot axes)
///   triple  the first three rows are a full translational triple. In world axes they are +-[1 | A]: only A is
///   computed,
///           kept and multiplied; the rows after them turn only. R turns the link's axes into the world's.
enum class RowLayout : unsigned char { dense, triple };
constexpr int n_columns(RowLayout layout) { return layout == RowLayout::dense ? 6 : 3; }

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

/// What a block's numbers mean: its rows, slots and layout.
struct RowShape {
  int m = 0, n = 0;
  RowLayout layout = RowLayout::dense;
  double sign = 1;  ///< triple: +1 when the first slot is P's body, -1 when only S's moves; a second slot has -1

  int ld() const { return pack_size(m); }  ///< numbers from one column to the next
  std::size_t R() const { return at(3); }
  std::size_t J(int i) const { return at(3 + (layout == RowLayout::triple ? 3 : 0) + n_columns(layout) * i); }
  std::size_t size() const { return J(n); }
  double sign_of(int i) const { return i == 0 ? sign : -1.0; }

 private:
  std::size_t at(int column) const { return static_cast<std::size_t>(column * ld()); }
};

/// The rows of one link, to be written and read.
class RowBlock {
 public:
  RowBlock(double* base, const RowShape& shape) : p_(base), shape_(shape), ld_(shape.ld()) {}

  int rows() const { return shape_.m; }
  int slots() const { return shape_.n; }
  RowLayout layout() const { return shape_.layout; }
  double& C(int k) const { return p_[k]; }
  double& Ct(int k) const { return p_[ld_ + k]; }
  double& Qhat(int k) const { return p_[2 * ld_ + k]; }

  /// Row k on the link's i-th slot: 6 numbers, v (world) then w (slot axes).
  std::array<double, 6> J(int i, int k) const {
    const double* a = p_ + shape_.J(i);
    if (shape_.layout == RowLayout::dense)
      return {a[k], a[ld_ + k], a[2 * ld_ + k], a[3 * ld_ + k], a[4 * ld_ + k], a[5 * ld_ + k]};
    if (k >= 3) return {0, 0, 0, a[k], a[ld_ + k], a[2 * ld_ + k]};
    const double* r = p_ + shape_.R() + k * ld_;  // column k of R: the link's axis k in the world
    const double s = shape_.sign_of(i);
    const auto turned = [&](int c) { return r[0] * a[c * ld_] + r[1] * a[c * ld_ + 1] + r[2] * a[c * ld_ + 2]; };
    return {s * r[0], s * r[1], s * r[2], turned(0), turned(1), turned(2)};
  }

  /// Row k on slot number i; i < 0 (a grounded side) is ignored. In a triple only rows that turn, v being zero.
  template <class V, class W>
  void set(int i, int k, const V& v, const W& w) const {
    if (i < 0) return;
    double* r = p_ + shape_.J(i) + k;
    if (shape_.layout == RowLayout::dense) {
      r[0] = v[0], r[ld_] = v[1], r[2 * ld_] = v[2];
      r += 3 * ld_;
    }
    r[0] = w[0], r[ld_] = w[1], r[2 * ld_] = w[2];
  }
  template <class V, class W>
  void add(int i, int k, const V& v, const W& w) const {
    if (i < 0) return;
    const std::array<double, 6> r = J(i, k);
    set(i, k, Vec3(r[0] + v[0], r[1] + v[1], r[2] + v[2]), Vec3(r[3] + w[0], r[4] + w[1], r[5] + w[2]));
  }

  /// Triple: link axes -> world, and the angular part of the first three rows on slot i, in world axes.
  template <class M>
  void set_R(const M& R) const {
    put(p_ + shape_.R(), R);
  }
  template <class M>
  void set_A(int i, const M& A) const {
    if (i >= 0) put(p_ + shape_.J(i), A);
  }

  /// All numbers of the block, the padding (zeros) included.
  const double* numbers() const { return p_; }
  std::size_t size() const { return shape_.size(); }

 private:
  template <class M>
  void put(double* a, const M& A) const {
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) a[c * ld_ + k] = A(k, c);
  }
  double* p_;
  RowShape shape_;
  int ld_;
};

/// The rows of a group, link after link.
class RowSpan {
 public:
  RowSpan(double* base, const RowShape& shape) : base_(base), shape_(shape), stride_(stride(shape)) {}
  RowBlock lane(std::size_t k) const { return {base_ + k * stride_, shape_}; }
  /// Numbers from one link to the next: blocks begin where packs may stand.
  static std::size_t stride(const RowShape& shape) { return aligned_to(shape.size(), 8); }

 private:
  double* base_;
  RowShape shape_;
  std::size_t stride_;
};

/// Where the rows of one active link stand.
struct RowEntry {
  int link = 0;       ///< number of the link in the system
  int first_row = 0;  ///< its first row among all active ones
  int m = 0;          ///< its rows
  SlotList slots;
  RowLayout layout = RowLayout::dense;
  double sign = 1;         ///< as in RowShape
  std::size_t offset = 0;  ///< of its block in the table
  std::array<RowKind, kMaxRows> kind{};

  RowShape shape() const { return {m, slots.n, layout, sign}; }
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
      at += RowSpan::stride(e.shape());
    }
    data_.assign(at, 0.0);  // what pads the columns stays zero
  }
  RowBlock block(const RowEntry& e) const { return {data_.data() + e.offset, e.shape()}; }
  RowSpan span(const RowEntry& first) const { return {data_.data() + first.offset, first.shape()}; }
  const double* data() const { return data_.data(); }
  double* data() { return data_.data(); }

 private:
  mutable Aligned<double> data_;
};

}  // namespace lockstep
