// BlockPlan: the symbolic half of the block factorisation: who is eliminated when, and where every number is stored
// (framework/docs/solvers.md, section 4).
//
// Nodes are slots and links, edges what couples them: a link its slots, a stiff force two slots. Leaves go first, so
// that a tree makes no fill: the dual of the articulated-body recursion (Baraff 1996; Featherstone 2008).
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <lockstep/export.h>

namespace lockstep {

/// What is coupled with what. Nodes 0 .. n_slots - 1 are slots, then come links.
struct BlockGraph {
  std::vector<int> width;  ///< unknowns of a slot, rows of a link; 1 .. kMaxBlock
  std::vector<int> first;  ///< the first of them in the vectors of unknowns and rows
  int n_slots = 0;
  std::vector<std::pair<int, int>> edges;  ///< any order, repeated or not, never a node with itself
};

inline constexpr int kMaxBlock = 8;

struct LOCKSTEP_API BlockPlan {
  /// One pivot; D is the place of its block.
  struct Node {
    int node = 0, width = 0, first = 0;
    std::size_t D = 0;
    int first_later = 0, n_later = 0;
    std::size_t first_target = 0;
    double sign = 1;  ///< of its block, where the matrix is quasi-definite: -1 for a link
  };
  /// What a pivot is coupled with among those that come after it: block A(pivot, later), row-major, at U; for an
  /// unsymmetric matrix the transpose of A(later, pivot) directly behind it.
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
  std::vector<Later> later;          ///< of one pivot after another, by rising place
  std::vector<std::size_t> targets;  ///< of each pivot: for b = 0.., for a = 0..b: the block of later a and later b
  std::vector<int> place_of_node;    ///< in `nodes`
  std::size_t size = 0;              ///< numbers in all
  bool symmetric = false;
  bool tree = false;  ///< no closed loop of links, the ground being one body: rows of different links are independent
  long multiplications = 0;  ///< of one factorisation

  /// Orders by least fill. A link waits until a slot of its own is gone that has still room for its rows, or all of
  /// them are: before that its pivot is nothing but the proximal term, and digits are lost.
  void lay_out(const BlockGraph&, bool is_symmetric);
  /// The proximal term against a row's scale. A closed loop's rows may depend on one another, and then share their
  /// force in its metric; on a tree it only keeps a link of its own dependent rows from having no pivot, and costs a
  /// long chain no digits.
  double proximal() const { return tree ? 1e-13 : 1e-8; }
  /// Nodes that are coupled in the graph, or one with itself. A symmetric plan keeps one of the two.
  Place find(int row, int column) const;
  /// The one above the diagonal of A(row, column) and A(column, row); `transposed`: it is that of A(column, row).
  Place find_above(int row, int column) const;
};

}  // namespace lockstep
