// SPDX-License-Identifier: BSD-3-Clause
// TreeClosures: the rows that close the loops of a batch in joint coordinates: their arrays, and the rule by which each
// lane is corrected. Private to the room.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <lockstep/author/memory.h>
#include <lockstep/math.h>
#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/tools/batch/lane_passes.h"
#include "framework/tools/batch/lane_plan.h"

namespace lockstep::lanes {

// Packs of eight numbers, one of each copy, as they are stored.

using Numbers8 = std::array<double, kLanes>;
using Flags8 = std::array<bool, kLanes>;

/// Arrays of packs.
class Arrays {
 public:
  /// One more, of zeros; not empty.
  std::span<double> add(std::size_t packs) { return all_.emplace_back(kL * std::max<std::size_t>(packs, 1), 0.0); }

 private:
  std::vector<Aligned<double>> all_;
};

/// Writes a number, numbers or a matrix, row after row, of one copy.
inline void put_number(std::span<double> to, std::size_t at, int lane, double value) { to[kL * at + lane] = value; }
template <class M>
void put_numbers(std::span<double> to, std::size_t at, int lane, const M& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i)
    put_number(to, at + static_cast<std::size_t>(i), lane, values.data()[i]);
}
/// A vector's, in this order of the axes.
template <class V>
void put_axes(std::span<double> to, std::size_t at, int lane, const std::array<int, 3>& axes, const V& a) {
  for (std::size_t i = 0; i < 3; ++i) put_number(to, at + i, lane, a[axes[i]]);
}
inline void put_axes(std::span<double> to, std::size_t at, int lane, const std::array<int, 3>& axes, const Quat& q) {
  put_number(to, at, lane, q.w), put_axes(to, at + 1, lane, axes, Vec3(q.vec()));
}
inline void put_matrix(std::span<double> to, std::size_t at, int lane, const Mat3& A) {
  put_numbers(to, at, lane, Mat3(A.transpose()));
}

/// A symmetric matrix in this order of the axes.
inline Mat3 in_order(const std::array<int, 3>& axes, const Mat3& J) {
  Mat3 out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out(i, j) = J(axes[i], axes[j]);
  return out;
}
/// xx xy xz yy yz zz
inline Eigen::Matrix<double, 6, 1> packed(const Mat3& J) {
  return {J(0, 0), J(0, 1), J(0, 2), J(1, 1), J(1, 2), J(2, 2)};
}

inline bool any(const Flags8& f) {
  return std::ranges::any_of(f, [](bool x) { return x; });
}

class TreeClosures {
 public:
  using Systems = std::array<System*, kLanes>;
  using Layouts = std::array<const TreeLayout*, kLanes>;
  /// Of systems whose layouts are alike, whose tree is in the data; nothing where these have no rows. The data and passes
  /// outlive this.
  TreeClosures(const Systems&, const Layouts&, LaneData&, const Passes&);

  bool empty() const { return data_.loops.empty(); }
  bool has_laws() const { return has_laws_; }
  /// Whether links write rows of their own, which needs the motions of the copies.
  bool has_own_rows() const { return !data_.loops.own.empty(); }
  /// Sets the laws of the links of one copy, and the rows that they write. Throws what they throw.
  void fill(const System&, int lane, const Inputs&);

  /// Accelerations at the motions that the tree has; true in the lanes whose rows are not met. The first n are looked at.
  Flags8 accelerate(int n, double* rate);
  /// Of the last of them: how many pivots are small, and the smallest of the others, relative to its diagonal.
  void see_pivots();
  double n_small(int lane) const { return n_small_[lane]; }
  double smallest_pivot(int lane) const { return smallest_pivot_[lane]; }

  /// C and Cd = J v + Ct at the motions that the tree has; the second alone after new velocities.
  void gather() { pass_.closure_errors(data_); }
  void gather_rates() { pass_.closure_rates(data_); }
  /// Their largest numbers, as Evaluation::norm measures them.
  Numbers8 norm_C() { return norm(data_.c.rows.C); }
  Numbers8 norm_Cd() { return norm(data_.c.Cd); }
  /// The elimination of the rows as gathered last.
  void factor() { pass_.factor_closures(data_); }
  /// The change of the velocities of least kinetic energy by which C or Cd vanish in the wanted lanes; none in others.
  const double* correct_C(const Flags8& wanted) { return correct(data_.c.rows.C, wanted); }
  const double* correct_Cd(const Flags8& wanted) { return correct(data_.c.Cd, wanted); }

 private:
  // Residuals of rows, relative to their scales: the largest, and that of rows that are not redundant.
  struct Residuals {
    Numbers8 all, regular;
    bool met(int lane) const { return all[lane] <= kRowTolerance; }
  };
  Residuals residuals();
  Numbers8 norm(std::span<const double>);
  const double* correct(std::span<const double> r, const Flags8& wanted);

  LaneData& data_;
  const Passes& pass_;
  RowTable scratch_;  // of one link
  bool has_laws_ = false;
  Arrays arrays_;  // of data_.c
  Aligned<double> masked_, dv_;
  Numbers8 length_{}, n_small_{}, smallest_pivot_{};
};

}  // namespace lockstep::lanes
