// The links as a graph: slots joined by links. Whether it is a tree, which slots are hubs, and in which order its nodes
// are eliminated. Setup only: what the solvers' plans are made from.
#pragma once

#include <set>
#include <span>
#include <tuple>
#include <vector>

namespace lockstep {

using Neighbours = std::vector<std::vector<int>>;  ///< of each node, sorted, none with itself

/// Couples two nodes, once.
void couple(Neighbours&, int a, int b);

/// Sets that grow together (union-find).
class Parts {
 public:
  explicit Parts(int n);
  /// One member that stands for the part of k.
  int of(int k);
  /// Makes one part of two; false when they are one already.
  bool join(int a, int b);

 private:
  std::vector<int> root_;
};

/// Which slots each link touches; the ground is none of them.
struct LinkGraph {
  int n_slots = 0;
  std::vector<std::vector<int>> slots;  ///< of each link

  std::vector<std::vector<int>> links_of_slots() const;
  /// No closed loop, the ground being one body: rows of different links cannot depend on one another by topology.
  bool is_tree() const;
};

/// Order of elimination by minimum degree: next goes the node whose neighbours weigh least, and of equals the one that
/// was touched longest ago, so that pivots that follow one another do not wait for one another. Leaves go first, and a
/// tree makes no fill.
class MinimumDegree {
 public:
  /// weights: what each node adds to the degree of its neighbours: 1, or its unknowns.
  MinimumDegree(Neighbours neighbours, std::vector<int> weights);

  bool done() const { return queue_.empty(); }
  struct Pivot {
    int node = 0;
    std::vector<int> below;  ///< nodes that are coupled with it when it goes, sorted
  };
  /// Eliminates the next node; those below it are coupled with one another from then on.
  Pivot next();
  /// A node that is held goes when no free one is left.
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
