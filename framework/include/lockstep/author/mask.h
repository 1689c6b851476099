// SPDX-License-Identifier: BSD-3-Clause
// Masks and axes: which coordinates a lock holds.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <lockstep/detail/export.h>

namespace lockstep {

// Mask: which of the six coordinates a lock holds. All 64 masks are valid joints (theory, (4.23)).

/// A set of rows of a lock: x y z, translations of P in S axes, m; e1 e2 e3, the vector part of the error quaternion,
/// which is half the rotation vector for small rotations.
enum class Mask : std::uint8_t {
  none = 0,   ///< no row
  x = 1,      ///< along x of S
  y = 2,      ///< along y of S
  z = 4,      ///< along z of S
  e1 = 8,     ///< about x
  e2 = 16,    ///< about y
  e3 = 32,    ///< about z
  xyz = 7,    ///< all translations
  e123 = 56,  ///< all rotations
  all = 63    ///< all six
};
/// Rows of a or of b.
constexpr Mask operator|(Mask a, Mask b) { return Mask(std::uint8_t(a) | std::uint8_t(b)); }
/// Rows of both.
constexpr Mask operator&(Mask a, Mask b) { return Mask(std::uint8_t(a) & std::uint8_t(b)); }
/// Whether a has all rows of `bits`.
constexpr bool includes(Mask a, Mask bits) { return (a & bits) == bits; }
/// Whether a has at least one row of `bits`.
constexpr bool overlaps(Mask a, Mask bits) { return (a & bits) != Mask::none; }
/// The mask of row k alone; k = 0..5 for x y z e1 e2 e3.
constexpr Mask row_bit(int k) { return Mask(1u << k); }
/// Number of rows.
constexpr int count_rows(Mask a) {
  int n = 0;
  for (int k = 0; k < 6; ++k) n += includes(a, row_bit(k));
  return n;
}

/// The six coordinates of P relative to S: translations along the axes of S, m, and rotations about them, rad.
enum class Axis : std::uint8_t { x, y, z, rx, ry, rz };
/// 0..5 for x y z rx ry rz.
constexpr int axis_index(Axis a) { return static_cast<int>(a); }
/// Whether the coordinate is a rotation.
constexpr bool is_rotation(Axis a) { return axis_index(a) >= 3; }
/// The row that a drive on this axis adds.
constexpr Mask row_of(Axis a) { return row_bit(axis_index(a)); }

/// "x y z e1 e2" -> Mask; commas and | separate words as well. Throws ParameterError (key "mask"): a word that is not a
/// row, a row named twice.
LOCKSTEP_API Mask mask_from(std::string_view words);
/// Mask -> "x y z e1 e2"; "" for an empty mask.
LOCKSTEP_API std::string to_string(Mask);
/// "x", "rz" -> Axis; throws ParameterError (key "axis") for any other word.
LOCKSTEP_API Axis axis_from(std::string_view word);
/// Axis -> "x", "rz".
LOCKSTEP_API std::string_view to_string(Axis);
/// "x" "y" "z" "e1" "e2" "e3" for k = 0..5.
LOCKSTEP_API std::string_view row_name(int k);

}  // namespace lockstep
