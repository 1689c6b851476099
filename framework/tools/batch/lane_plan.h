// The plan of a batch: the plan of the elimination (dynamics/solvers/schur_plan.h) in packs of eight, and where the data
// of each link are. Private to the room.
#pragma once

#include <array>
#include <vector>

#include "framework/dynamics/solvers/schur_plan.h"
#include <lockstep/system.h>

namespace lockstep {
class MarkerLock;
}

namespace lockstep::lanes {

inline constexpr int kLanes = 8;
inline constexpr std::size_t kL = kLanes;  // as an index

/// How the rotational half of a link is calculated.
enum class Turn : unsigned char { none, parallel, plain, law };

/// Where the data of one link are.
struct Link {
  int link = 0;         ///< in the system
  int m = 0;            ///< rows
  bool triple = false;  ///< the first three rows are a full translation, in world axes
  bool moved = false;   ///< a law moves its translation
  Turn turn = Turn::none;
  std::array<int, 6> row{};      ///< row k is this row of the lock
  int P = 0, S = 0;              ///< slots; the ground is the number of slots
  int side_P = -1, side_S = -1;  ///< among the sides; -1: the ground
  std::size_t frames = 0;        ///< of its markers, frames::size packs
  std::size_t law = 0;           ///< of its laws, law::size packs, where there are any
  std::size_t x = 0;             ///< of its rows, m packs

  bool has_laws() const { return moved || turn == Turn::law; }
};

struct Plan : schur::Plan {
  std::vector<Link> links;  ///< of each node
  int n_states = 0;
  std::size_t size_frames = 0, size_law = 0;

  std::size_t v_at() const { return 7 * static_cast<std::size_t>(n_slots); }   ///< velocities of a state
  std::size_t s_at() const { return 13 * static_cast<std::size_t>(n_slots); }  ///< its own states
  std::size_t n() const { return s_at() + static_cast<std::size_t>(n_states); }
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

/// Why the mechanism cannot run in lanes whatever its coordinates; "" if it can. The system is set up.
std::string unsuited(const System&);
/// Why its rows have no lanes, for a mechanism that is suited; "" if they have.
std::string unsuited_rows(const System&);
Plan make_plan(const System&);

}  // namespace lockstep::lanes
