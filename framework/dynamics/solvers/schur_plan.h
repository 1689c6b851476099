// SchurPlan: the symbolic half of the solver `schur`: who is eliminated when, and where every number stands.
//
// Nodes are links; a slot with many links (a hub) is a node as well, because eliminating it first would couple all its
// links with one another. Leaves go first, so that a tree makes no fill (Baraff 1996).
#pragma once

#include <vector>

#include "framework/mechanism/rows/rows.h"
#include "framework/foundation/support/export.h"

namespace lockstep::schur {

/// One slot that a link touches. Offsets count doubles: J in the row table, Y in SchurNumbers::Y.
struct Side {
  int slot = 0;
  double sign = 1;  ///< of the v-part of a triple
  bool hub = false;
  std::size_t J = 0, Y = 0;
};

/// Block of the factor below a pivot: rows of node `node`, columns of the pivot.
struct Later {
  int node = 0, m = 0;
  std::size_t x = 0;      ///< of its unknowns
  std::size_t block = 0;  ///< m_node x m_pivot, column after column, in SchurNumbers::A
  int first_term = 0, n_terms = 0;
};

/// One share of such a block in S: both nodes touch one slot. A hub is its own slot: then its side is -1.
struct Term {
  int pivot_side = 0, later_side = 0;
};

struct Node {
  int m = 0;            ///< unknowns: rows of a link, velocities of a hub
  int link = -1;        ///< position in RowTable::entries; -1: a hub
  int hub_slot = -1;    ///< the slot of a hub
  bool on_hub = false;  ///< a link that touches one
  RowLayout layout = RowLayout::dense;
  int first_row = 0;     ///< of a link, among the table's
  std::size_t rows = 0;  ///< offset of its block in the row table
  std::size_t R = 0;     ///< triple: offset of R there
  int first_side = 0, n_sides = 0;
  std::size_t x = 0;  ///< of its unknowns in the vectors of the solver: a pack each
  std::size_t D = 0;  ///< of its own block in SchurNumbers::A, m columns
  int first_later = 0, n_later = 0;
  int first_target = 0;                      ///< of its products, in Plan::targets
  unsigned translations = 0, rotations = 0;  ///< bits of rows by kind; the others are functions

  int ld() const { return pack_size(m); }
};

struct Plan {
  std::vector<Node> nodes;  ///< in the order of elimination
  std::vector<Side> sides;
  std::vector<Later> later;
  std::vector<Term> terms;
  std::vector<std::size_t> targets;  ///< where the product of two blocks below a pivot goes: s = 0.., t = 0..s
  std::vector<int> hubs;             ///< nodes that are hubs
  std::size_t size_x = 0, size_A = 0, size_Y = 0;
  int n_slots = 0, n_rows = 0;
  bool planar = false;  ///< three velocities a slot
  bool tree = false;    ///< no closed loop, the ground being one body: rows cannot be redundant by topology

  /// Slots with more links than this become nodes.
  static constexpr int kHub = 6;
};

LOCKSTEP_API Plan make_plan(const RowTable& rows, int n_slots, bool planar);

}  // namespace lockstep::schur
