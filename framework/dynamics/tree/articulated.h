// ArticulatedBodies: the recursion on a tree in space.
#pragma once

#include <limits>
#include <vector>

#include <lockstep/memory.h>
#include "framework/dynamics/tree/columns.h"
#include "framework/dynamics/tree/joint_tree.h"
#include "framework/dynamics/tree/largest.h"
#include "framework/dynamics/tree/loop_closures.h"

namespace lockstep {

/// A force and a moment, an acceleration and an angular one: world axes, of a mass centre.
struct alignas(kColumn) SpatialWrench {
  Column f{}, t{};
};
struct alignas(kColumn) SpatialTwist {
  Column a{}, al{};
};

/// The recursion in space, as TreeRecursion has it. World axes; wrenches and accelerations of a slot about its mass centre.
class LOCKSTEP_API ArticulatedBodies {
 public:
  using Closures = LoopClosures<SpatialWrench, SpatialTwist>;
  ArticulatedBodies(const JointTree&, const System&, bool has_closures);
  void outward(const JointTree&, const State&, std::vector<Motion>& motions);
  void accelerate(const JointTree&, std::span<const Motion> motions, const VecX& f, VecX& vd);
  void accelerate(const JointTree&, std::span<const Motion> motions, const VecX& f, Closures&, VecX& vd);
  void follow(const JointTree&);
  void add(const Closures&);
  void read_off(const JointTree&, std::span<const Motion> motions, const VecX& a, VecX& vd);
  void accelerations(const JointTree&, std::span<const Motion> motions, VecX& a) const;
  const Largest& largest() const { return largest_; }

 private:
  // An articulated inertia and its bias: force = M a + H al + pf, moment = H' a + I al + pt. H' has its own columns.
  struct alignas(kColumn) Inertia {
    Columns M, H, H_t, I;
    Column pf, pt;
    void add(const Inertia&);
    void add_row(const SpatialWrench& K, double l, double d_1);
  };
  struct alignas(64) Node {  // three cache lines
    Column r;        // from the parent's mass centre
    Column ca, cal;  // accelerations where the coordinates' own are zero
    SpatialTwist found;
    Vec3 w = Vec3::Zero();  // world axes
    // Inward, what children have passed on waits on a stack: the place of the node's own, -1 of a leaf; that of its
    // parent's, kRoot of a root; of the first that waits there the place's complement.
    int own = -1, to = kRoot;
  };
  static constexpr int kRoot = std::numeric_limits<int>::max();
  // Of a slot alone, slot axes: J by its columns from the diagonal on.
  struct Mass {
    double m, J[6];
  };
  // A velocity coordinate: motion (l, n) of the slot per unit, U = IA (l, n), D = (l, n) U, a number: the coordinates of
  // one joint are eliminated one after another, as if each had a joint of its own, the first at the slot. The inverse of
  // all of D at once would lose the small inertia of a bar about its own axis.
  struct alignas(kColumn) Dof {
    Column l, n, Uf, Ut;
    double u, D_1;
  };
  // The passes of closures through a node's joint: LoopClosures.
  struct Joint {
    const Node& b;
    const Dof* dof;
    int n_v;
    void pass(SpatialWrench& K, double& l, double* kappa, double* V) const;
    void pass_again(SpatialWrench& p, double* u) const;
    SpatialTwist solve_again(const SpatialTwist& parent, const double* u, const double* less, double* dv) const;
  };
  Joint joint(const JointTree&, std::size_t node) const;
  SpatialWrench read_side(const RowView&, int i, int k, std::size_t node, const Motion&, double& diagonal) const;
  double move_to_joint(std::size_t, SpatialWrench&) const { return 0; }  // it is the mass centre
  const SpatialTwist& acceleration(std::size_t node) const { return nodes_[node].found; }
  friend Closures;
  [[gnu::noinline]] void outward_moving(const TreeNode&, const State&, const Motion& p, const Vec3& wp, Motion& own,
                                        Node&);
  Inertia inertia_of(std::size_t node, const Motion&, const double* f) const;
  template <int k>
  void eliminate(const TreeNode&, const Node&, Inertia&);
  template <int k>
  void solve(const TreeNode&, Node&, VecX& vd, const double* less);
  SpatialTwist carried(const TreeNode&, const Node&) const;
  template <class Rows>
  void accelerate_with(const JointTree&, std::span<const Motion> motions, const VecX& f, Rows& rows, VecX& vd);
  void find_largest();

  std::vector<Mass> masses_;  // of the slots, by node
  std::vector<Node> nodes_;
  std::vector<Dof> dofs_;
  std::vector<Inertia> waiting_;
  std::vector<double> inverse_mass_;          // of the slots, by node, where there are closures;
  std::vector<Mat3> inverse_J_;       // slot axes
  Largest largest_;
};

}  // namespace lockstep
