// SPDX-License-Identifier: BSD-3-Clause
// The recursion in a plane: three numbers a force.
#include "framework/dynamics/tree/planar_motion.h"
#include "framework/dynamics/tree/recursion_in.h"
#include "framework/foundation/math/sin_cos.h"

namespace lockstep {

namespace {

/// The nodes of a tree with planar() joints, which outlives this. Inertias, forces and accelerations of a slot about the
/// point of its joint.
class PlanarSlots {
 public:
  using Space = bodies::InPlane<double>;
  using Twist = Space::Twist;
  using Largest = lockstep::Largest;
  using Wrench = Space::Wrench;

  PlanarSlots(const JointTree& tree, const System& system, bool)
      : tree_(tree),
        joints_(*tree.planar()),
        i_(static_cast<std::size_t>(joints_.plane().i())),
        j_(static_cast<std::size_t>(joints_.plane().j())),
        n_(3 - i_ - j_) {
    const std::vector<PlanarNode>& nodes = joints_.nodes();
    nodes_.resize(nodes.size() + 1), frames_.resize(nodes_.size());
    if (std::ranges::any_of(nodes, [](const PlanarNode& n) { return n.n_slides > 0 || !n.turns; }))
      dofs_.resize(tree.n_v());
    const std::vector<InwardPlace> places = inward_places(nodes, n_waiting_);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const PlanarNode& n = nodes[k];
      const Slot& slot = system.slot(n.slot);
      const Vec3 normal = joints_.normal(n);
      Node& b = nodes_[k + 1];
      b.m = slot.mass, b.J = normal.dot(slot.J * normal), b.place = places[k], b.posture = n.posture;
      b.slot = n.slot, b.parent = n.parent, b.first_v = n.first_v, b.n_v = n.n_slides + (n.turns ? 1 : 0);
      if (n.turns && n.n_slides == 0) b.sign = n.sign > 0 ? 1 : -1;
      if (n.turns && n.n_slides > 0) dofs_[n.first_v + n.n_slides].S.al = n.sign;
    }
  }

  std::size_t size() const { return nodes_.size() - 1; }
  int parent(std::size_t k) const { return nodes_[k + 1].parent; }
  int first_v(std::size_t k) const { return nodes_[k + 1].first_v; }
  const InwardPlace& place(std::size_t k) const { return nodes_[k + 1].place; }
  std::size_t n_waiting() const { return n_waiting_; }
  template <class F>
  LOCKSTEP_INLINE void with_joint(std::size_t k, F&& f) {
    Node& b = nodes_[k + 1];
    if (b.sign != 0)
      f(bodies::PlanarHinge{b.hinge, static_cast<double>(b.sign), b.r, b.c});
    else
      f(bodies::JointPasses<Space>{dofs_.data() + b.first_v, b.n_v, b.r, b.c});
  }

  LOCKSTEP_INLINE void outward(const State& y, std::vector<Motion>& motions) {
    motions.resize(nodes_.size());
    if (n_ == 0) return outward_along<0>(y, motions);
    if (n_ == 1) return outward_along<1>(y, motions);
    outward_along<2>(y, motions);
  }
  /// M = m 1, h = m n x d, I = J + m d^2, p = -m w^2 d - f, tau = d x p - moment
  LOCKSTEP_INLINE void add_slot(std::size_t k, std::span<const Motion>, const VecX& f, Space::Inertia& IA) const {
    const Node& b = nodes_[k + 1];
    const double* on = f.data() + 6 * b.slot;
    const Flat e = across(b.d), h = b.m * e, p = (-b.m * b.w * b.w) * b.d - Flat{on[i_], on[j_]};
    const double moment = b.posture < 0 ? on[3 + n_] : normal(k).dot(Vec3(on[3], on[4], on[5]));
    IA.Mii += b.m, IA.Mjj += b.m, IA.h += h, IA.p.f += p;
    IA.I += b.J + dot(e, h), IA.p.t += dot(e, p) - moment;
  }

  const Twist& found(std::size_t k) const { return nodes_[k + 1].found; }
  LOCKSTEP_INLINE Twist centre(std::size_t k) const {
    const Node& b = nodes_[k + 1];
    return {b.found.a + beyond_point(b, b.found.al), b.found.al};
  }
  LOCKSTEP_INLINE Twist put(std::size_t k, const Twist& found) { return nodes_[k + 1].found = found, centre(k); }
  Twist read(std::size_t k, std::span<const Motion>, const VecX& a) const {
    const double* of = a.data() + 6 * nodes_[k + 1].slot;
    const double al = normal(k).dot(Vec3(of[3], of[4], of[5]));
    return {Flat{of[i_], of[j_]} - beyond_point(nodes_[k + 1], al), al};
  }
  void write(std::size_t k, std::span<const Motion>, VecX& a) const {
    const Twist of = centre(k);
    const int at = 6 * nodes_[k + 1].slot;
    double* out = a.data() + at;
    out[i_] = of.a.i, out[j_] = of.a.j, out[n_] = 0;
    a.segment<3>(at + 3) = of.al * normal(k);
  }

  LOCKSTEP_INLINE Wrench read_side(const RowView& rows, int i, int k, std::size_t node, const Motion& motion,
                                   double& diagonal) const {
    const Node& b = nodes_[node + 1];
    std::array<double, 3> J;
    if (rows.layout() == RowLayout::planar || rows.layout() == RowLayout::pair) {
      J = rows.J_in_plane(i, k);
    } else {
      const std::array<double, 6> all = rows.J(i, k);
      const Vec3 normal = motion.A.row(static_cast<Eigen::Index>(n_));  // in slot axes
      J = {all[i_], all[j_], normal.dot(Vec3(all[3], all[4], all[5]))};
    }
    diagonal += (J[0] * J[0] + J[1] * J[1]) / b.m;
    if (b.J > 0) diagonal += J[2] * J[2] / b.J;  // else a particle
    return {{J[0], J[1]}, J[2]};
  }
  LOCKSTEP_INLINE double move_to_joint(std::size_t node, Wrench& K) const {
    const Node& b = nodes_[node + 1];
    K = bodies::about(b.d, K);
    return -b.w * b.w * dot(K.f, b.d);
  }

 private:
  // What the passes read and write, apart from what the motion alone needs.
  struct Node {
    Flat d,  // from the joint's point to the centre of mass
        r;   // from the point of the parent's joint
    Twist c;
    bodies::PlanarHinge::Own hinge;
    Twist found;          // of the joint's point
    double m = 0, J = 0,  // mass of the slot alone, inertia about its centre of mass
        w = 0;            // angular velocity
    InwardPlace place;
    int slot = 0, parent = -1, first_v = 0, posture = -1;  // as those of the PlanarNode
    int n_v = 0, sign = 0;                                 // sign: of a hinge alone; 0: of another joint
  };

  // a = a_p + al_p x r + ca,  ca = -w_p^2 r + 2 w x slide + ..., of the slot's point that is at the joint's point now
  template <int k>
  LOCKSTEP_INLINE void outward_along(const State& y, std::vector<Motion>& motions) {
    const std::vector<PlanarNode>& nodes = joints_.nodes();
    SinCosAhead half;
    for (std::size_t l = 0; l < nodes.size(); ++l) {
      half.see(
          l, nodes.size(), [&](std::size_t i) __attribute__((always_inline)) {
            return half_turn(nodes[i], y.q.data() + nodes[i].first_q);
          });
      const PlanarNode& n = nodes[l];
      const auto from = static_cast<std::size_t>(n.parent + 1);
      const PlanarFrame& p = frames_[from];
      PlanarFrame& own = frames_[l + 1];
      Node& b = nodes_[l + 1];
      PlanarImposed now;
      if (n.law >= 0) now = planar_laws_at(tree_.nodes()[l], joints_.law(n), y.t, y.s);
      const double *q = y.q.data() + n.first_q, *v = y.v.data() + n.first_v;
      const PlanarCarried add = carry(n, n.law < 0 ? nullptr : &now, half.cosine(), half.sine(), q, v, p, own);
      b.r = nodes_[from].d + add.d1, b.d = add.d2, b.w = own.w;
      b.c = {-p.w * p.w * b.r, 0.0};
      if (n.n_slides > 0 || n.law >= 0) {
        const PlanarFrame& carrier = n.reversed ? own : p;
        b.c.a += 2.0 * carrier.w * across(add.slide) + add.pdd;
        b.c.al = add.alpha;
        for (int i = 0; i < n.n_slides; ++i) dofs_[n.first_v + i].S.a = turned(carrier.c, carrier.s, n.slide[i]);
      }
      write_motion<k>(own, joints_.posture(n), motions[n.slot + 1]);
    }
  }
  Vec3 normal(std::size_t k) const { return joints_.normal(joints_.nodes()[k]); }
  // The centre of mass has a + al n x d - w^2 d.
  LOCKSTEP_INLINE static Flat beyond_point(const Node& b, double al) { return al * across(b.d) - (b.w * b.w) * b.d; }

  const JointTree& tree_;
  const PlanarJoints& joints_;
  std::size_t i_, j_, n_;                        // axes of the plane and its normal
  std::vector<Node> nodes_;                      // the ground first
  std::vector<PlanarFrame> frames_;              // likewise
  std::vector<bodies::Coordinate<Space>> dofs_;  // of joints that are not hinges alone
  std::size_t n_waiting_ = 0;
};

}  // namespace

std::unique_ptr<TreeRecursion> recursion_in_plane(std::shared_ptr<const JointTree> tree, const System& system,
                                                  ClosureFronts closures) {
  return std::make_unique<RecursionIn<PlanarSlots>>(std::move(tree), system, std::move(closures));
}

}  // namespace lockstep
