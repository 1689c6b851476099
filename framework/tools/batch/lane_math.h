// Numbers that are packs, one value per copy; vectors of them are those of math/vec.h. Private to the room.
//
// Compiled once per instruction set, in the namespace LOCKSTEP_SET, with packs of LOCKSTEP_WIDE lanes, as many as a
// register holds. Everything is always inlined, so that it is compiled for the instruction set of the calling pass. In
// memory there are always eight lanes side by side; narrower packs make several rounds (lane_all.h).
#pragma once

#include <lockstep/jet.h>
#include <lockstep/vec.h>
#include "framework/dynamics/tree/spaces.h"
#include "framework/tools/batch/lane_plan.h"

#define LOCKSTEP_LANE LOCKSTEP_INLINE

namespace lockstep::lanes::LOCKSTEP_SET {

inline constexpr int kWide = LOCKSTEP_WIDE;  ///< lanes in one register
using V = Pack<kWide>;                       ///< of the eight that are stored side by side

LOCKSTEP_LANE V load(const double* p, std::size_t at) { return *reinterpret_cast<const V*>(p + kLanes * at); }
LOCKSTEP_LANE void store(double* p, std::size_t at, const V& v) { *reinterpret_cast<V*>(p + kLanes * at) = v; }
using bodies::magnitude, bodies::square_root;
LOCKSTEP_LANE V larger(const V& a, const V& b) { return a > b ? a : b; }
/// The larger one; a NaN stays.
LOCKSTEP_LANE V largest_or_nan(const V& most, const V& x) {
  const V next = x <= most ? most : x;
  return most != most ? most : next;
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
using Space = bodies::InSpace<V>;
using Symmetric = bodies::Symmetric<V>;

/// An array of eight lanes: [i] is its pack i, + i what begins there.
struct LaneArray {
  double* p;
  LOCKSTEP_LANE V& operator[](int i) const { return *reinterpret_cast<V*>(p + kLanes * i); }
  LOCKSTEP_LANE LaneArray operator+(int n) const { return {p + kLanes * n}; }
};
template <class T>
LOCKSTEP_LANE T* pack(T* p, std::size_t at) {
  return p + kLanes * at;
}

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
