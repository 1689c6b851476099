// SPDX-License-Identifier: BSD-3-Clause
// SchurPlan: the symbolic half of the elimination: the order of the nodes, and where every number is stored; the numeric
// half is elimination.h.
//
// Nodes are links; a slot with many links (a hub) is a node as well, because eliminating it first would couple all its
// links with one another. Leaves go first, so that a tree makes no fill (Baraff 1996).
#pragma once

#include <span>
#include <vector>

#include <lockstep/detail/export.h>
#include <lockstep/detail/rows.h>
#include "framework/dynamics/solvers/operations.h"
#include "framework/dynamics/solvers/scales.h"

namespace lockstep::schur {

/// One slot that a link touches.
struct Side {
  int slot = 0;
  double sign = 1;      ///< of the v-part of a triple
  bool turned = false;  ///< the first rows are +-[1 | A], in world axes, of which J and Y store only A (RowLayout)
  bool hub = false;
  std::size_t J = 0, Y = 0;  ///< offsets; J in the row table
};

/// Block of the factor below a pivot: rows of node `node`, columns of the pivot.
struct Later {
  int node = 0, m = 0;
  std::size_t x = 0;      ///< of its unknowns
  std::size_t block = 0;  ///< in Numbers::A
  int first_term = 0, n_terms = 0;
};

/// One term of such a block in S, of a slot that both nodes touch. A hub is its own slot: its side is then -1.
struct Term {
  int pivot_side = 0, later_side = 0;
};

struct Node {
  int m = 0;            ///< unknowns: rows of a link, velocities of a hub
  int link = -1;        ///< position in RowTable::entries; -1: a hub
  int hub_slot = -1;    ///< the slot of a hub
  bool on_hub = false;  ///< a link that touches one
  bool turned = false;  ///< as its sides are
  int n_turned = 0;     ///< rows that R turns
  int first_row = 0;    ///< of a link, among the table's
  std::size_t R = 0;    ///< offset of R in the row table
  int first_side = 0, n_sides = 0;
  std::size_t x = 0;  ///< of its unknowns in the vectors
  std::size_t D = 0;  ///< of its own block in Numbers::A
  int first_later = 0, n_later = 0;
  int first_target = 0;  ///< of its products, in Plan::targets
  KindBits kinds;

  int ld() const { return pack_size(m); }
};

struct LOCKSTEP_API Plan {
  std::vector<Node> nodes;  ///< in the order of elimination
  std::vector<Side> sides;
  std::vector<Later> later;
  std::vector<Term> terms;
  std::vector<std::size_t> targets;  ///< where the product of two blocks below a pivot goes: s = 0.., t = 0..s
  std::vector<int> hubs;             ///< nodes that are hubs
  std::size_t size_x = 0, size_A = 0, size_Y = 0;
  int n_slots = 0, n_rows = 0;
  bool planar = false;  ///< three velocities per slot
  bool tree = false;    ///< no closed loop, the ground being one body: rows cannot be redundant by topology

  /// Slots with more links than this become nodes.
  static constexpr int kHub = 6;

  std::span<const Side> sides_of(const Node& node) const {
    return {sides.data() + node.first_side, size(node.n_sides)};
  }
  std::span<const Later> later_of(const Node& node) const {
    return {later.data() + node.first_later, size(node.n_later)};
  }
  std::span<const Term> terms_of(const Later& block) const {
    return {terms.data() + block.first_term, size(block.n_terms)};
  }

 private:
  static std::size_t size(int n) { return n; }
};

LOCKSTEP_API Plan make_plan(const RowTable& rows, int n_slots, bool planar);
/// Of a factorisation and its solutions, in packs: two where rows may be redundant; rows are written.
LOCKSTEP_API Operations count_operations(const Plan&);

}  // namespace lockstep::schur
