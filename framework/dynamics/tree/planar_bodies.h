// PlanarBodies: accelerations of a tree in a plane by its articulated inertias, three numbers a body.
#pragma once

#include <vector>

#include <lockstep/state.h>
#include <lockstep/system.h>
#include "framework/dynamics/tree/inward_places.h"
#include "framework/dynamics/tree/joint_tree.h"
#include "framework/dynamics/tree/largest.h"
#include "framework/dynamics/tree/loop_closures.h"
#include "framework/dynamics/tree/planar_motion.h"

namespace lockstep {

/// A force and a moment, an acceleration and an angular one, in the plane.
struct FlatWrench {
  Flat f;
  double t = 0;
};
struct FlatTwist {
  Flat a;
  double al = 0;
};

/// The recursion in a plane, as TreeRecursion has it, for a tree with planar() joints. Inertias, wrenches and accelerations
/// of a slot about the point of its joint.
class LOCKSTEP_API PlanarBodies {
 public:
  using Closures = LoopClosures<FlatWrench, FlatTwist>;
  PlanarBodies(const JointTree&, const System&, bool has_closures);
  void outward(const JointTree&, const State&, std::vector<Motion>& motions);
  void accelerate(const JointTree&, std::span<const Motion> motions, const VecX& f, VecX& vd);
  void accelerate(const JointTree&, std::span<const Motion> motions, const VecX& f, Closures&, VecX& vd);
  void follow(const JointTree&);
  void add(const Closures&);
  void read_off(const JointTree&, std::span<const Motion> motions, const VecX& a, VecX& vd);
  void accelerations(const JointTree&, std::span<const Motion> motions, VecX& a) const;
  const Largest& largest() const { return largest_; }

 private:
  // force = M a + h al + p, moment = h' a + I al + tau
  struct Inertia {
    double Mii = 0, Mij = 0, Mjj = 0, I = 0, tau = 0;
    Flat h, p;
    void add(const Inertia&);
    void add_row(const FlatWrench& K, double l, double d_1);
  };
  struct Node : InwardPlace {
    PlanarFrame frame;
    Flat d,          // from the joint's point to the mass centre
        r,           // from the point of the parent's joint
        ca,          // acceleration of the point where the coordinates' own are zero
        g;           // al = u - g' a', by the turn's D^-1 U and D^-1 u; of a hinge al = u - g' a_p - gs al_p
    double cal = 0,  // angular acceleration by laws
        u = 0, gs = 0, D_1 = 0;
    FlatTwist found;             // of the joint's point
    Flat centre;                 // acceleration of the mass centre
    double m = 0, J = 0;         // mass of the slot alone, inertia about its mass centre
  };
  // A translation: direction l, U = IA l.
  struct Slide {
    Flat l, U;
    double U_turn, u, D_1;
  };
  // The passes of closures through a node's joint: LoopClosures.
  struct Joint {
    const Node& b;
    const Slide* slides;
    int n_slides;
    bool turns;
    double sign;  // of the turn
    void pass(FlatWrench& K, double& l, double* kappa, double* V) const;
    void pass_again(FlatWrench& p, double* u) const;
    FlatTwist solve_again(const FlatTwist& parent, const double* u, const double* less, double* dv) const;
  };
  Joint joint(const PlanarNode& n, const Node& b) const {
    return {b, slides_.data() + n.first_v, n.n_slides, n.turns, n.sign};
  }
  Joint joint(const JointTree& tree, std::size_t node) const {
    return joint(tree.planar()->nodes()[node], nodes_[node + 1]);
  }
  FlatWrench read_side(const RowView&, int i, int k, std::size_t node, const Motion&, double& diagonal) const;
  double move_to_joint(std::size_t node, FlatWrench&) const;
  FlatTwist acceleration(std::size_t node) const { return {nodes_[node + 1].centre, nodes_[node + 1].found.al}; }
  friend Closures;
  template <int k>
  void outward_along(const JointTree&, const PlanarJoints&, const State&, std::vector<Motion>&);
  template <int k, class Rows>
  void inward_along(const PlanarJoints&, const VecX& f, Rows&);
  template <class Rows>
  void accelerate_with(const JointTree&, const VecX& f, Rows&, VecX& vd);
  void find_largest();
  static bool is_hinge(const PlanarNode& n) { return n.turns && n.n_slides == 0; }
  static Flat at_centre(const Node& b) {
    return b.found.a + (b.found.al * across(b.d) - (b.frame.w * b.frame.w) * b.d);
  }
  static void pass_hinge(Node&, Inertia&);
  void eliminate(const PlanarNode&, Node&, Inertia&);
  static void shift(const Node&, Inertia&);
  FlatTwist solve(const PlanarNode&, const Node&, const FlatTwist& parent, const double* less, VecX& vd) const;

  std::size_t plane_i_ = 0, plane_j_ = 1, plane_n_ = 2;  // axes of the plane, and its normal
  std::vector<Node> nodes_;    // the ground first
  std::vector<Slide> slides_;  // by number of the velocity
  std::vector<Inertia> waiting_;
  Largest largest_;
};

}  // namespace lockstep
