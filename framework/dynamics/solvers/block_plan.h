// SPDX-License-Identifier: BSD-3-Clause
// BlockPlan: the symbolic half of the block factorisation: the order of elimination, and where every number is stored
// (framework/docs/solvers.md, section 4).
//
// Nodes are slots and links; a link is coupled with its slots, and a stiff force couples two slots. Leaves go first, so
// that a tree makes no fill: the dual of the articulated-body recursion (Baraff 1996; Featherstone 2008).
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <lockstep/detail/export.h>
#include "framework/dynamics/solvers/stop_rule.h"

namespace lockstep {

/// The graph of couplings. Nodes 0 .. n_slots - 1 are slots, then come links.
struct BlockGraph {
  std::vector<int> width;  ///< unknowns of a slot, rows of a link; 1 .. kMaxBlock
  std::vector<int> first;  ///< the first of them in the vectors of unknowns and rows
  int n_slots = 0;
  std::vector<std::pair<int, int>> edges;  ///< in any order, repeated or not, never a node with itself
};

inline constexpr int kMaxBlock = 8;

struct LOCKSTEP_API BlockPlan {
  /// One pivot; D is the offset of its block.
  struct Node {
    int node = 0, width = 0, first = 0;
    std::size_t D = 0;
    int first_later = 0, n_later = 0;
    std::size_t first_target = 0;
    double sign = 1;  ///< of its block, where the matrix is quasi-definite: -1 for a link
  };
  /// A later node that a pivot is coupled with: block A(pivot, later), row-major, at U; in an unsymmetric matrix
  /// followed by the transpose of A(later, pivot).
  struct Later {
    int width = 0, first = 0;
    int place = 0;  ///< in `nodes`
    std::size_t U = 0;
  };
  /// Where the block A(row, column) is stored; `transposed`: as its transpose.
  struct Place {
    std::size_t at = 0;
    bool transposed = false;
  };

  std::vector<Node> nodes;           ///< in the order of elimination
  std::vector<Later> later;          ///< pivot by pivot, by rising place
  std::vector<std::size_t> targets;  ///< of each pivot: for b = 0.., for a = 0..b: the block of later a and later b
  std::vector<int> place_of_node;    ///< in `nodes`
  std::size_t size = 0;              ///< total count of numbers
  bool symmetric = false;
  bool tree = false;  ///< no closed loop of links, the ground being one body: rows of different links are independent

  /// Orders by least fill. A link waits until one of its slots that has room for its rows is eliminated, or all of them
  /// are: before that its pivot is only the proximal term, and digits are lost.
  void lay_out(const BlockGraph&, bool is_symmetric);
  /// The proximal term relative to a row's scale. The rows of a closed loop may be dependent, and then share their
  /// force in its metric; on a tree it only keeps the pivot of a link whose own rows are dependent, and is small enough
  /// to cost a long chain no digits.
  double proximal() const { return tree ? 1e-13 : kProximalOfMatrix; }
  /// For nodes that are coupled in the graph, or equal. A symmetric plan stores one of the two.
  Place find(int row, int column) const;
  /// The one of A(row, column) and A(column, row) that is above the diagonal; `transposed`: it is A(column, row).
  Place find_above(int row, int column) const;
};

}  // namespace lockstep
