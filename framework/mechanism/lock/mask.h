// Mask: which of the six rows of a lock are in force. All 64 combinations are joints (theory, (4.23)).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "framework/foundation/support/export.h"

namespace lockstep {

/// x y z: translations of P in S's axes; e1 e2 e3: components of the error quaternion (half turns about x y z of S).
enum class Mask : std::uint8_t {
  none = 0,
  x = 1,
  y = 2,
  z = 4,
  e1 = 8,
  e2 = 16,
  e3 = 32,
  xyz = 7,
  e123 = 56,
  all = 63
};
constexpr Mask operator|(Mask a, Mask b) { return Mask(std::uint8_t(a) | std::uint8_t(b)); }
constexpr Mask operator&(Mask a, Mask b) { return Mask(std::uint8_t(a) & std::uint8_t(b)); }
constexpr bool has(Mask a, Mask bits) { return (a & bits) == bits; }
constexpr bool any(Mask a, Mask bits) { return (a & bits) != Mask::none; }
constexpr Mask row_bit(int k) { return Mask(1u << k); }
constexpr int count(Mask a) {
  int n = 0;
  for (int k = 0; k < 6; ++k) n += has(a, row_bit(k));
  return n;
}

/// The six coordinates of P seen from S: translations along, turns about the axes of S.
enum class Axis : std::uint8_t { x, y, z, rx, ry, rz };
constexpr int index(Axis a) { return static_cast<int>(a); }
constexpr bool is_rotation(Axis a) { return index(a) >= 3; }
/// The row that a drive on this axis adds.
constexpr Mask row_of(Axis a) { return row_bit(index(a)); }

/// "x y z e1 e2" -> Mask; throws ParameterError (key "mask") naming the word that is not a row.
LOCKSTEP_API Mask mask_from(std::string_view words);
LOCKSTEP_API std::string to_string(Mask);
/// "x", "rz" -> Axis; throws ParameterError (key "axis").
LOCKSTEP_API Axis axis_from(std::string_view word);
LOCKSTEP_API std::string_view to_string(Axis);
/// "x" "y" "z" "e1" "e2" "e3" for k = 0..5.
LOCKSTEP_API std::string_view row_name(int k);

}  // namespace lockstep
