// SPDX-License-Identifier: BSD-3-Clause
// The graph of the links, which join slots: whether it is a tree, and in which order its nodes are eliminated. The
// solvers' plans are made from it at setup.
#pragma once

#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include <boost/container/small_vector.hpp>
#include <boost/pending/disjoint_sets.hpp>

#include <lockstep/author/passes.h>
#include <lockstep/detail/export.h>

namespace lockstep {

using Neighbours = std::vector<std::vector<int>>;  ///< of each node, sorted, without itself

/// Couples two nodes, once.
void couple(Neighbours&, int a, int b);

using Parts = boost::disjoint_sets_with_storage<>;  ///< of a graph
/// Merges the parts of two nodes; false when they are one already.
inline bool join(Parts& parts, int a, int b) {
  const int one = parts.find_set(a), two = parts.find_set(b);
  parts.link(one, two);
  return one != two;
}

/// Which slots each link touches; the ground is not a slot.
struct LinkGraph {
  int n_slots = 0;
  std::vector<boost::container::small_vector<int, 4>> slots;  ///< of each link

  std::vector<std::vector<int>> links_of_slots() const;
  /// No closed loop, the ground being one body: rows of different links cannot depend on one another by topology.
  bool is_tree() const;
};

LinkGraph link_graph(const RowTable&, int n_slots);
/// Whether links in force close a loop, so that rows may depend on one another in some positions. Of a system that is
/// set up.
LOCKSTEP_API bool has_loops(const System&, const std::vector<bool>& modes);

/// What the rows of a link touch, sorted: its slots, and the ground where a marker is fixed. Rows of the user's own may
/// know where they are in the world, and those of a particle how it is turned: they count as touching the ground.
LOCKSTEP_API std::vector<int> ends_of(const System&, const Lock&);

/// The number of the group of each edge; edges of one group lie on common loops (biconnected components), or join the same
/// nodes. An edge joins two nodes of kGround, 0, 1, ... n_slots - 1.
LOCKSTEP_API std::vector<std::size_t> loop_groups(int n_slots, const std::vector<std::pair<int, int>>& edges);

/// Order of elimination by minimum degree: next is the node whose neighbours weigh least, and of equals the one touched
/// longest ago, so that successive pivots do not wait for each other. Leaves go first, and a tree makes no fill.
class MinimumDegree {
 public:
  /// weights: what each node adds to the degree of its neighbours: 1, or its unknowns.
  MinimumDegree(Neighbours neighbours, std::vector<int> weights);

  bool done() const { return queue_.empty(); }
  struct Pivot {
    int node = 0;
    std::vector<int> below;  ///< nodes that are coupled with it when it is eliminated, sorted
  };
  /// Eliminates the next node; those below it become coupled with one another.
  Pivot next();
  /// A node that is held is eliminated only when no free one is left.
  void hold(int node, bool on);

 private:
  using Key = std::tuple<bool, int, int, int>;  // held, degree, touched, node
  Key key(int node) const;

  Neighbours neighbours_;
  std::vector<int> weights_, touched_;
  std::vector<bool> held_, gone_;
  std::set<Key> queue_;
  int clock_ = 0;
};

}  // namespace lockstep
