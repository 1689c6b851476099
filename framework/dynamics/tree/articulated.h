// ArticulatedBodies: accelerations of a tree by its articulated inertias (Featherstone 2008, chapter 7).
#pragma once

#include <vector>

#include <lockstep/memory.h>
#include "framework/dynamics/tree/joint_tree.h"

namespace lockstep {

/// The recursion and its scratch. World axes; wrenches and accelerations of a slot about its mass centre.
class ArticulatedBodies {
 public:
  /// Sizes everything for this tree, and reads the masses of the slots of its system.
  void begin(const JointTree&, const System&);
  /// First pass, outward: motions of all slots (the ground is motions[0], at rest), joint axes and velocity products.
  void outward(const JointTree&, const State&, std::vector<Motion>& motions);
  /// The other two passes: accelerations of the coordinates under f, 6 per slot: N (world) and N m (slot axes), -w x J w
  /// included.
  void accelerate(const JointTree&, std::span<const Motion> motions, const VecX& f, VecX& vd);
  /// Largest acceleration of a slot, m/s^2, and its largest angular acceleration, rad/s^2, as found last.
  double largest_a() const { return largest_a_; }
  double largest_alpha() const { return largest_alpha_; }

 private:
  // force = M a + H al + pf, moment = H' a + I al + pt
  struct Node {
    Mat3 M, H, I;
    Vec3 pf, pt;
    Vec3 r;               // from the parent's mass centre
    Vec3 ca, cal;         // accelerations where the coordinates' own are zero
    Vec3 w;               // world axes
    Vec3 a, al;           // found
    double m = 0;         // mass of the slot alone,
    Mat3 J;               // and its inertia, slot axes
    std::size_t D_1 = 0;  // where D^-1 begins in inverse_
  };
  // A velocity coordinate: motion (l, n) of the slot per unit, U = IA (l, n).
  struct Dof {
    Vec3 l, n, Uf, Ut;
    double u;
  };
  template <int k>
  void eliminate(const TreeNode&, Node&);
  template <int k>
  void reduce(const TreeNode&, Node&);
  template <int k>
  void solve(const TreeNode&, Node&, VecX& vd);

  std::vector<Node> nodes_;
  std::vector<Dof> dofs_;
  std::vector<double> inverse_;  // D^-1 of all nodes, row by row
  double largest_a_ = 0, largest_alpha_ = 0;
};

}  // namespace lockstep
