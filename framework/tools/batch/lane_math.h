// Numbers that are packs, one value per copy; vectors of them are those of math/vec.h. Private to the room.
//
// Compiled once per instruction set, in the namespace LOCKSTEP_SET, with packs of LOCKSTEP_WIDE lanes, as many as a
// register holds. Everything is always inlined, so that it is compiled for the instruction set of the calling pass. In
// memory there are always eight lanes side by side; narrower packs make several rounds (lane_all.h).
#pragma once

#include <cmath>

#include <lockstep/jet.h>
#include <lockstep/vec.h>
#include "framework/tools/batch/lane_plan.h"

#define LOCKSTEP_LANE LOCKSTEP_INLINE

namespace lockstep::lanes::LOCKSTEP_SET {

inline constexpr int kWide = LOCKSTEP_WIDE;  ///< lanes in one register
using V = Pack<kWide>;                       ///< of the eight that are stored side by side

LOCKSTEP_LANE V load(const double* p, std::size_t at) { return *reinterpret_cast<const V*>(p + kLanes * at); }
LOCKSTEP_LANE void store(double* p, std::size_t at, const V& v) { *reinterpret_cast<V*>(p + kLanes * at) = v; }
LOCKSTEP_LANE V size_of(const V& v) { return v < 0.0 ? -v : v; }
LOCKSTEP_LANE V larger(const V& a, const V& b) { return a > b ? a : b; }
/// The larger one; a NaN stays.
LOCKSTEP_LANE V largest_or_nan(const V& most, const V& x) {
  const V next = x <= most ? most : x;
  return most != most ? most : next;
}

LOCKSTEP_LANE V square_root(const V& a) {
  V r{};
  for (int l = 0; l < kWide; ++l) r[l] = std::sqrt(a[l]);
  return r;
}

LOCKSTEP_LANE auto load3(const double* p, std::size_t at) {
  return vec::Vector{load(p, at), load(p, at + 1), load(p, at + 2)};
}
LOCKSTEP_LANE auto load9(const double* p, std::size_t at) {
  return vec::Matrix{load3(p, at), load3(p, at + 3), load3(p, at + 6)};
}
LOCKSTEP_LANE auto load4(const double* p, std::size_t at) { return vec::Quaternion{load(p, at), load3(p, at + 1)}; }
using V3 = decltype(load3(nullptr, 0));
using M3 = decltype(load9(nullptr, 0));
using Q4 = decltype(load4(nullptr, 0));

LOCKSTEP_LANE void store(double* p, std::size_t at, vec::Zero) { store(p, at, V{}); }
LOCKSTEP_LANE void store(double* p, std::size_t at, vec::One) { store(p, at, V{} + 1.0); }
LOCKSTEP_LANE void store3(double* p, std::size_t at, const V3& v) {
  store(p, at, v.x), store(p, at + 1, v.y), store(p, at + 2, v.z);
}
template <class X, class Y, class Z>
LOCKSTEP_LANE void store3(double* p, std::size_t at, const vec::Vector<X, Y, Z>& v) {
  store(p, at, v.x), store(p, at + 1, v.y), store(p, at + 2, v.z);
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
