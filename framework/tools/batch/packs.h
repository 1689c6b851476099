// SPDX-License-Identifier: BSD-3-Clause
// Packs of eight numbers, one of each copy, as they are stored. Private to the room.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <lockstep/author/memory.h>
#include <lockstep/math.h>
#include "framework/tools/batch/lane_plan.h"

namespace lockstep::lanes {

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

}  // namespace lockstep::lanes
