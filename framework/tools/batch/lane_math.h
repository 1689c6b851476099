// SPDX-License-Identifier: BSD-3-Clause
// Numbers that are packs, one value per copy, and arrays of them. Private to the room.
//
// Compiled once per instruction set, in the namespace LOCKSTEP_SET, with packs of LOCKSTEP_WIDE lanes, as many as a
// register holds. Everything is always inlined, so that it is compiled for the instruction set of the calling pass. In
// memory there are always eight lanes side by side; narrower packs make several rounds (lane_all.h).
#pragma once

#include <lockstep/author/jet.h>
#include "framework/tools/batch/lane_plan.h"
#include "framework/tools/batch/number_arrays.h"

namespace lockstep::lanes::LOCKSTEP_SET {

inline constexpr int kWide = LOCKSTEP_WIDE;  ///< lanes in one register
using V = Pack<kWide>;                       ///< of the eight that are stored side by side

/// An array of eight lanes: [i] is its pack i, + i what begins there.
struct LaneArray {
  double* p = nullptr;
  LOCKSTEP_LANE LaneArray() = default;
  LOCKSTEP_LANE LaneArray(const double* numbers) : p(const_cast<double*>(numbers)) {}
  LOCKSTEP_LANE explicit operator bool() const { return p != nullptr; }
  template <class I>
  LOCKSTEP_LANE V& operator[](I i) const {
    return *reinterpret_cast<V*>(p + kLanes * static_cast<std::ptrdiff_t>(i));
  }
  template <class I>
  LOCKSTEP_LANE LaneArray operator+(I n) const {
    return {p + kLanes * static_cast<std::ptrdiff_t>(n)};
  }
};

}  // namespace lockstep::lanes::LOCKSTEP_SET
