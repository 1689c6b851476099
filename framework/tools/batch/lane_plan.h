// LanePlan: the symbolic half of the copies: which numbers stand where, counted in packs of eight. Private to the room.
//
// Order of elimination, targets and terms are those of the solver `schur` (dynamics/solvers/schur_plan.h).
#pragma once

#include <array>
#include <vector>

#include "framework/dynamics/solvers/schur_plan.h"
#include "framework/mechanism/system/system.h"

namespace lockstep {
class MarkerLock;
}

namespace lockstep::lanes {

inline constexpr int kLanes = 8;

/// One moving body that a link touches; columns of J and Y.
struct Side {
  int slot = 0;
  double sign = 1;  ///< of the v part of a triple: J = sign 1
  bool triple = false;
  std::size_t J = 0, Y = 0;
};

/// How the rotational half of a link is calculated.
enum class Turn : unsigned char { none, parallel, plain, law };

struct Node {
  int m = 0;
  bool triple = false;  ///< the first three rows are a full translation, in world axes
  bool moved = false;   ///< a law moves its translation
  Turn turn = Turn::none;
  std::array<int, 6> row{};  ///< row k is this row of the lock
  std::array<RowKind, 6> kind{};
  int P = 0, S = 0;              ///< slots; the ground is the number of slots
  int side_P = -1, side_S = -1;  ///< among the sides; -1: the ground
  int first_side = 0, n_sides = 0;
  std::size_t frames = 0;  ///< of its markers, kFrames packs
  std::size_t law = 0;     ///< of its laws, kLaw packs, where there are any
  std::size_t x = 0;       ///< of its unknowns, m packs
  std::size_t D = 0;       ///< lower triangle of its own block
  int first_later = 0, n_later = 0, first_target = 0;
};

struct Later {
  int node = 0, m = 0;
  std::size_t x = 0, block = 0;  ///< m_later x m_pivot, row after row
  int first_term = 0, n_terms = 0;
};

struct Plan {
  std::vector<Node> nodes;
  std::vector<Side> sides;
  std::vector<Later> later;
  std::vector<schur::Term> terms;  ///< numbers of sides
  std::vector<std::size_t> targets;
  std::vector<int> link;  ///< of each node, in the system
  int n_slots = 0, n_states = 0;
  std::size_t size_x = 0, size_A = 0, size_J = 0, size_Y = 0, size_frames = 0, size_law = 0;
  bool tree = false;

  std::size_t v_at() const { return 7 * static_cast<std::size_t>(n_slots); }   ///< velocities of a state
  std::size_t s_at() const { return 13 * static_cast<std::size_t>(n_slots); }  ///< its own states
  std::size_t n() const { return s_at() + static_cast<std::size_t>(n_states); }
};

/// Of a body: x 3 | A 9 | e 4 | v 3 | w 3, slot axes | w 3, world.
namespace body {
inline constexpr std::size_t x = 0, A = 3, e = 12, v = 16, w = 19, W = 22, size = 25;
}
/// Of a slot: 1/m | J^-1 xx xy xz yy yz zz | m | J likewise.
namespace mass {
inline constexpr std::size_t inverse = 0, Jinv = 1, m = 7, J = 8, size = 14;
}
/// Markers of a link: P: u 3 | q 4 | A 9, S the same.
namespace frames {
inline constexpr std::size_t uP = 0, qP = 3, AP = 7, uS = 16, qS = 19, AS = 23, size = 32;
}
/// Laws of a link: p, pd, pdd | q_D | A_D | w, a.
namespace law {
inline constexpr std::size_t p = 0, pd = 3, pdd = 6, q = 9, A = 13, w = 22, a = 25, size = 28;
}

/// In words why the mechanism cannot run in lanes; "" if it can. The system is set up.
std::string unsuited(const System&);
Plan make_plan(const System&);

}  // namespace lockstep::lanes
