// ArticulatedBodies: accelerations of a tree by its articulated inertias (Featherstone 2008, chapter 7).
#pragma once

#include <vector>

#include <lockstep/memory.h>
#include "framework/dynamics/tree/columns.h"
#include "framework/dynamics/tree/joint_tree.h"

namespace lockstep {

class LoopClosures;

/// The recursion and its scratch. World axes; wrenches and accelerations of a slot about its mass centre.
class LOCKSTEP_API ArticulatedBodies {
 public:
  /// Sizes everything for this tree, and reads the masses of the slots of its system.
  void begin(const JointTree&, const System&);
  /// First pass, outward: motions of all slots (the ground is motions[0], at rest), joint axes and velocity products.
  void outward(const JointTree&, const State&, std::vector<Motion>& motions);
  /// The other two passes: accelerations of the coordinates under f, 6 per slot: N (world) and N m (slot axes), -w x J w
  /// included.
  void accelerate(const JointTree&, std::span<const Motion> motions, const VecX& f, VecX& vd);
  /// The same with closures, whose rows were gathered at the same motions: their first multipliers are found as well.
  void accelerate(const JointTree&, std::span<const Motion> motions, const VecX& f, LoopClosures&, VecX& vd);
  /// Adds to the accelerations as found last what the closures' last correction changes.
  void add_correction(const LoopClosures&);
  /// Takes accelerations of the slots, 6 per slot as in accelerations(), for those found last, and reads off the
  /// coordinates' own; what the joints do not let happen is lost.
  void read_off(const JointTree&, std::span<const Motion> motions, const VecX& a, VecX& vd);
  /// Accelerations as found last, 6 per slot: m/s^2 (world), rad/s^2 (slot axes).
  void accelerations(const JointTree&, std::span<const Motion> motions, VecX& a) const;
  /// Largest acceleration of a slot, m/s^2, and its largest angular acceleration, rad/s^2, as found last.
  double largest_a() const { return largest_a_; }
  double largest_alpha() const { return largest_alpha_; }

 private:
  // An articulated inertia and its bias: force = M a + H al + pf, moment = H' a + I al + pt. H' has its own columns.
  struct alignas(kColumn) Inertia {
    Columns M, H, H_t, I;
    Column pf, pt;
    void add(const Inertia&);
  };
  struct alignas(kColumn) Node {
    Column r;        // from the parent's mass centre
    Column ca, cal;  // accelerations where the coordinates' own are zero
    Column a, al;    // found
    Vec3 w;          // world axes
    double m = 0;    // mass of the slot alone,
    Mat3 J;          // and its inertia, slot axes
    int D_1 = 0;     // where D^-1 begins in inverse_
    // Inward, what children have passed on waits on a stack: the place of the node's own, -1 of a leaf; that of its
    // parent's, -1 of a root; whether it is the first there.
    int own = -1, to = -1;
    bool first = false;
  };
  // A velocity coordinate: motion (l, n) of the slot per unit, U = IA (l, n).
  struct alignas(kColumn) Dof {
    Column l, n, Uf, Ut;
    double u;
  };
  [[gnu::noinline]] void outward_moving(const TreeNode&, const State&, const Motion& p, const Vec3& wp, Motion& own,
                                        Node&);
  Inertia inertia_of(const Node&, const Motion&, const double* f) const;
  template <int k>
  void eliminate(const TreeNode&, const Node&, const Inertia&);
  template <int k>
  void reduce(const TreeNode&, const Node&, Inertia&);
  template <int k>
  void solve(const TreeNode&, Node&, VecX& vd, const double* less);
  template <class Rows>
  void accelerate_with(const JointTree&, std::span<const Motion> motions, const VecX& f, Rows& rows, VecX& vd);
  void find_largest();
  friend class LoopClosures;  // eliminates its rows along with the bodies

  std::vector<Node> nodes_;
  std::vector<Dof> dofs_;
  std::vector<Inertia> waiting_;
  std::vector<double> inverse_;  // D^-1 of all nodes, row by row
  std::vector<double> half_, cosine_, sine_;  // of the hinges' angles, by node
  double largest_a_ = 0, largest_alpha_ = 0;
};

}  // namespace lockstep
