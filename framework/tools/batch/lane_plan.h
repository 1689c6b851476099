// SPDX-License-Identifier: BSD-3-Clause
// The links of a batch whose rows are written in lanes: locks that are masks, and where their numbers are. Private to the
// room.
#pragma once

#include <array>
#include <cstddef>

namespace lockstep::lanes {

inline constexpr int kLanes = 8;
inline constexpr std::size_t kL = kLanes;  // as an index

/// How the rotational half of a link is calculated.
enum class Turn : unsigned char { none, parallel, plain, law };

/// Where the data of one link are.
struct Link {
  int link = 0;        ///< in the system
  int m = 0;           ///< rows
  bool moved = false;  ///< a law moves its translation
  Turn turn = Turn::none;
  std::array<int, 6> row{};           ///< row k is this row of the lock
  int P = 0, S = 0;                   ///< slots; the ground is the number of slots
  std::ptrdiff_t J_P = -1, J_S = -1;  ///< of its Jacobians; -1: the ground
  std::size_t frames = 0;             ///< of its markers, frames::size packs
  std::size_t law = 0;                ///< of its laws, law::size packs, where there are any
  std::size_t x = 0;                  ///< of its rows, m packs

  bool has_laws() const { return moved || turn == Turn::law; }
};

/// Of a body: x 3 | A 9 | e 4 | v 3 | w 3, slot axes | w 3, world.
namespace body {
inline constexpr std::size_t x = 0, A = 3, e = 12, v = 16, w = 19, W = 22, size = 25;
}
/// Markers of a link: P: u 3 | q 4 | A 9, S the same.
namespace frames {
inline constexpr std::size_t uP = 0, qP = 3, AP = 7, uS = 16, qS = 19, AS = 23, size = 32;
}
/// Laws of a link: p, pd, pdd | q_D | A_D | w, a.
namespace law {
inline constexpr std::size_t p = 0, pd = 3, pdd = 6, q = 9, A = 13, w = 22, a = 25, size = 28;
}

}  // namespace lockstep::lanes
