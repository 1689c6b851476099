// PlanarBodies: accelerations of a tree in a plane by its articulated inertias, three numbers a body.
#pragma once

#include <vector>

#include <lockstep/state.h>
#include <lockstep/system.h>
#include "framework/dynamics/tree/joint_tree.h"
#include "framework/dynamics/tree/planar_motion.h"

namespace lockstep {

/// The recursion and its scratch, for a tree with planar() joints. Inertias, wrenches and accelerations of a slot about
/// the point of its joint.
class LOCKSTEP_API PlanarBodies {
 public:
  /// As those of ArticulatedBodies.
  void begin(const JointTree&, const System&);
  void outward(const JointTree&, const State&, std::vector<Motion>& motions);
  void accelerate(const JointTree&, const VecX& f, VecX& vd);
  void accelerations(const JointTree&, VecX& a) const;
  double largest_a() const { return largest_a_; }
  double largest_alpha() const { return largest_alpha_; }

 private:
  // force = M a + h al + p, moment = h' a + I al + tau
  struct Inertia {
    double Mii = 0, Mij = 0, Mjj = 0, I = 0, tau = 0;
    Flat h, p;
    void add(const Inertia&);
  };
  // Accelerations: of the joint's point, and of the slot about the normal.
  struct Found {
    Flat a;
    double al = 0;
  };
  static constexpr int kNext = -2;
  struct Node {
    PlanarFrame frame;
    Flat d,          // from the joint's point to the mass centre
        r,           // from the point of the parent's joint
        ca,          // acceleration of the point where the coordinates' own are zero
        g;           // al = u - g' a', by the turn's D^-1 U and D^-1 u; of a hinge al = u - g' a_p - gs al_p
    double cal = 0,  // angular acceleration by laws
        u = 0, gs = 0;
    Found found;
    double m = 0, J = 0;         // mass of the slot alone, inertia about its mass centre
    Vec3 normal = Vec3::Zero();  // in slot axes
    // Inward, a node takes over from the one that comes after it if that is its child; what other children pass on
    // waits.
    bool from_next = false;
    int own = -1,  // where that waits, -1: nowhere
        to = -1;   // where what it passes on waits; kNext: nowhere, the next takes it
  };
  // A translation: direction l, U = IA l.
  struct Slide {
    Flat l, U;
    double U_turn, u, D_1;
  };
  template <int k>
  void outward_along(const JointTree&, const PlanarJoints&, const State&, std::vector<Motion>&);
  template <int k>
  void inward_along(const PlanarJoints&, const VecX& f);
  static bool is_hinge(const PlanarNode& n) { return n.turns && n.n_slides == 0; }
  static Flat at_centre(const Node& b) {
    return b.found.a + (b.found.al * across(b.d) - (b.frame.w * b.frame.w) * b.d);
  }
  static void pass_hinge(Node&, Inertia&);
  void eliminate(const PlanarNode&, Node&, Inertia&);
  static void shift(const Node&, Inertia&);
  Found solve(const PlanarNode&, const Node&, const Found& parent, VecX& vd) const;

  std::vector<Node> nodes_;    // the ground first
  std::vector<Slide> slides_;  // by number of the velocity
  std::vector<Inertia> waiting_;
  std::vector<double> half_, cosine_, sine_;  // of the joints' angles
  double largest_a_ = 0, largest_alpha_ = 0;
};

}  // namespace lockstep
