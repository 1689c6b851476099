// Vectors, matrices and quaternions of which every number is a pack: one number a copy. Private to the room.
//
// Compiled once for each set of instructions, into a namespace of its own: LOCKSTEP_SET, with packs of LOCKSTEP_WIDE
// lanes, as many as a register holds. Everything is always inlined, so that it is compiled for the set of the pass that
// calls it. Lanes stand eight in a row in every case; narrower packs make several rounds (lane_all.h).
#pragma once

#include "framework/tools/batch/lane_plan.h"
#include "framework/foundation/math/pack.h"

#define LOCKSTEP_LANE [[gnu::always_inline]] inline

namespace lockstep::lanes::LOCKSTEP_SET {

inline constexpr int kWide = LOCKSTEP_WIDE;  ///< lanes in one register
using V = Pack<kWide>;                       ///< of the eight that stand in a row

LOCKSTEP_LANE V load(const double* p, std::size_t at) { return *reinterpret_cast<const V*>(p + kLanes * at); }
LOCKSTEP_LANE void store(double* p, std::size_t at, const V& v) { *reinterpret_cast<V*>(p + kLanes * at) = v; }
LOCKSTEP_LANE V size_of(const V& v) { return v < 0.0 ? -v : v; }
LOCKSTEP_LANE V larger(const V& a, const V& b) { return a > b ? a : b; }

struct V3 {
  V x, y, z;
};
LOCKSTEP_LANE V3 load3(const double* p, std::size_t at) { return {load(p, at), load(p, at + 1), load(p, at + 2)}; }
LOCKSTEP_LANE void store3(double* p, std::size_t at, const V3& v) {
  store(p, at, v.x), store(p, at + 1, v.y), store(p, at + 2, v.z);
}
LOCKSTEP_LANE V3 operator+(const V3& a, const V3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
LOCKSTEP_LANE V3 operator-(const V3& a, const V3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
LOCKSTEP_LANE V3 operator-(const V3& a) { return {-a.x, -a.y, -a.z}; }
LOCKSTEP_LANE V3 operator*(const V& s, const V3& a) { return {s * a.x, s * a.y, s * a.z}; }
LOCKSTEP_LANE V3 operator*(double s, const V3& a) { return {s * a.x, s * a.y, s * a.z}; }
LOCKSTEP_LANE V dot(const V3& a, const V3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
LOCKSTEP_LANE V3 cross(const V3& a, const V3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Rows r0 r1 r2.
struct M3 {
  V3 r0, r1, r2;
};
LOCKSTEP_LANE M3 load9(const double* p, std::size_t at) { return {load3(p, at), load3(p, at + 3), load3(p, at + 6)}; }
LOCKSTEP_LANE V3 operator*(const M3& A, const V3& b) { return {dot(A.r0, b), dot(A.r1, b), dot(A.r2, b)}; }
/// A^T b
LOCKSTEP_LANE V3 turned_back(const M3& A, const V3& b) {
  return {A.r0.x * b.x + A.r1.x * b.y + A.r2.x * b.z, A.r0.y * b.x + A.r1.y * b.y + A.r2.y * b.z,
          A.r0.z * b.x + A.r1.z * b.y + A.r2.z * b.z};
}
LOCKSTEP_LANE V3 column(const M3& A, int k) {
  return k == 0 ? V3{A.r0.x, A.r1.x, A.r2.x} : k == 1 ? V3{A.r0.y, A.r1.y, A.r2.y} : V3{A.r0.z, A.r1.z, A.r2.z};
}
LOCKSTEP_LANE V component(const V3& a, int k) { return k == 0 ? a.x : k == 1 ? a.y : a.z; }

struct Q4 {
  V w;
  V3 v;
};
LOCKSTEP_LANE Q4 load4(const double* p, std::size_t at) { return {load(p, at), load3(p, at + 1)}; }
/// (1.1)
LOCKSTEP_LANE Q4 operator*(const Q4& a, const Q4& b) {
  return {a.w * b.w - dot(a.v, b.v), a.w * b.v + b.w * a.v + cross(a.v, b.v)};
}
LOCKSTEP_LANE Q4 conjugate(const Q4& a) { return {a.w, -a.v}; }
/// (1.5)
LOCKSTEP_LANE M3 rotation(const Q4& q) {
  const V x2 = q.v.x + q.v.x, y2 = q.v.y + q.v.y, z2 = q.v.z + q.v.z;
  const V xx = q.v.x * x2, yy = q.v.y * y2, zz = q.v.z * z2, xy = q.v.x * y2, xz = q.v.x * z2, yz = q.v.y * z2;
  const V wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
  return {
      {1.0 - (yy + zz), xy - wz, xz + wy}, {xy + wz, 1.0 - (xx + zz), yz - wx}, {xz - wy, yz + wx, 1.0 - (xx + yy)}};
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
