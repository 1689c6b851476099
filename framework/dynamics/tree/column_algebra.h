// SPDX-License-Identifier: BSD-3-Clause
// Column and Columns: vectors of three numbers in packs of four, matrices of three such columns, and what is done with them: a
// column in one instruction. For files that are compiled for several instruction sets.
#pragma once

#include <cstddef>

#include <lockstep/author/jet.h>
#include <lockstep/math.h>

// As arguments of templates packs lose that they may alias, which is not needed there.
#pragma GCC diagnostic ignored "-Wignored-attributes"

namespace lockstep::bodies {

/// The fourth number is zero. If a struct holds columns they come first, and it has alignas(kColumn): the compiler
/// takes 16 bytes where it does not count on AVX, and 32 where it does.
using Column = Pack<4>;
inline constexpr std::size_t kColumn = 32;  ///< bytes

struct alignas(kColumn) Columns {
  Column c[3];
};

LOCKSTEP_INLINE Column column(const Vec3& v) { return Column{v[0], v[1], v[2], 0.0}; }
LOCKSTEP_INLINE Vec3 vector(const Column& v) { return {v[0], v[1], v[2]}; }
LOCKSTEP_INLINE Columns columns(const Mat3& A) { return {{column(A.col(0)), column(A.col(1)), column(A.col(2))}}; }

LOCKSTEP_INLINE double dot(const Column& a, const Column& b) {
  const Column p = a * b;
  return p[0] + p[1] + p[2];
}
LOCKSTEP_INLINE Column operator*(const Columns& A, const Column& b) {
  return A.c[0] * b[0] + A.c[1] * b[1] + A.c[2] * b[2];
}
LOCKSTEP_INLINE Column operator*(const Columns& A, const Vec3& b) {
  return A.c[0] * b[0] + A.c[1] * b[1] + A.c[2] * b[2];
}

/// r~: one side of a cross product, with its two rotations by one place.
struct Skew {
  Column yzx, zxy, r;
  LOCKSTEP_INLINE explicit Skew(const Column& v)
      : yzx(__builtin_shufflevector(v, v, 1, 2, 0, 3)), zxy(__builtin_shufflevector(v, v, 2, 0, 1, 3)), r(v) {}
};
/// r x b
LOCKSTEP_INLINE Column operator*(const Skew& S, const Column& b) {
  return S.yzx * __builtin_shufflevector(b, b, 2, 0, 1, 3) - S.zxy * __builtin_shufflevector(b, b, 1, 2, 0, 3);
}
/// A <- A - B r~
LOCKSTEP_INLINE void subtract_product(Columns& A, const Columns& B, const Skew& S) {
  A.c[0] -= B.c[1] * S.r[2] - B.c[2] * S.r[1];
  A.c[1] -= B.c[2] * S.r[0] - B.c[0] * S.r[2];
  A.c[2] -= B.c[0] * S.r[1] - B.c[1] * S.r[0];
}
/// A <- A + r~ B
LOCKSTEP_INLINE void add_product(Columns& A, const Skew& S, const Columns& B) {
  for (int k = 0; k < 3; ++k) A.c[k] += S * B.c[k];
}
/// A <- A - x y'
LOCKSTEP_INLINE void subtract_dyad(Columns& A, const Column& x, const Column& y) {
  for (int k = 0; k < 3; ++k) A.c[k] -= x * y[k];
}

}  // namespace lockstep::bodies
