// SPDX-License-Identifier: BSD-3-Clause
// ClosureFronts: at which nodes of a tree the rows of closures are open, where they end, and in which order.
#pragma once

#include <cstddef>
#include <vector>

#include <lockstep/detail/export.h>
#include <lockstep/detail/rows.h>
#include "framework/dynamics/tree/joint_tree.h"

namespace lockstep {

/// The rows at a node: first those that continue to its parent, then those that end here. Rows are in the order in
/// which they are eliminated, the last one first: those of a node follow each other at its parent in the same order.
struct ClosureFront {
  int first = 0, n_open = 0, n = 0;  ///< places
  int Lambda = 0;                    ///< where its n x n numbers begin
  int V = 0;                         ///< where V begins: n_v numbers for each open row
};

/// A slot of a row: its node, and the row's place there.
struct ClosureSide {
  int node = 0, place = 0;
};

/// A row of the table, and where its sides begin.
struct ClosureSource {
  int first_side = 0, n_sides = 0;
  RowKind kind = RowKind::translation;
};

/// A row is open from the nodes of its slots to where their paths meet, and ends there; at the ground if it touches that.
struct LOCKSTEP_API ClosureFronts {
  ClosureFronts() = default;
  /// Of a tree of this system, and the rows of its closures.
  ClosureFronts(const JointTree&, const System&, const RowTable&);

  int row_of(const ClosureFront& f, int i) const { return rows[f.first + i]; }

  /// The place of a row at the node of its first side, where its l begins.
  std::size_t place_of(std::size_t row) const { return static_cast<std::size_t>(sides[sources[row].first_side].place); }
  /// By node, then those of the ground: one for each link that ends there, in the order of their elimination.
  std::vector<ClosureFront> all;
  std::vector<std::size_t> parents;  ///< of each front the one that its open rows go to
  std::size_t n_nodes = 0;
  std::vector<int> rows,  ///< of each place: the row of the table,
      above;              ///< and of open rows the number at the parent
  int n_Lambda = 0, n_V = 0;
  std::vector<ClosureSource> sources;  ///< by row of the table
  std::vector<ClosureSide> sides;      ///< of all rows
  bool in_plane = false;               ///< all rows lie in the plane of the tree

 private:
  using Rows = std::vector<int>;
  void add(const Rows& open, const Rows& closing, int n_v);
  void add_at_ground(const std::vector<Rows>& entries, const std::vector<std::vector<int>>& together);
  void sort_open();
  void link();
  void add_sides(const RowTable&, const std::vector<std::size_t>& node_of);
};

}  // namespace lockstep
