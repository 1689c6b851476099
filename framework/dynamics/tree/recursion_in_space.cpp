// SPDX-License-Identifier: BSD-3-Clause
// The recursion in space.
#include <Eigen/LU>

#include "framework/dynamics/tree/moving_markers.h"
#include "framework/dynamics/tree/recursion_in.h"
#include "framework/dynamics/tree/tree_motion.h"
#include "framework/foundation/math/for_size.h"
#include "framework/foundation/math/sin_cos.h"

namespace lockstep {

namespace {

using bodies::Column, bodies::Columns, bodies::column, bodies::columns, bodies::vector;

constexpr std::size_t kAhead = 8;      // nodes
constexpr std::size_t kCached = 4096;  // nodes: what fewer take is in the cache anyway

// Slots may be numbered in another order than nodes: what a pass will read or write of a slot is asked for ahead.
template <int kWrites, class T>
LOCKSTEP_INLINE void ask_for(const T* first, std::size_t bytes) {
  for (std::size_t at = 0; at < bytes; at += 64) __builtin_prefetch(reinterpret_cast<const char*>(first) + at, kWrites);
}

/// The nodes of a tree which outlives this. World axes; inertias, forces, accelerations about centres of mass.
class SpatialSlots {
 public:
  using Space = bodies::InColumns;
  using Twist = Space::Twist;
  using Largest = lockstep::Largest;

  SpatialSlots(const JointTree& tree, const System& system, bool has_closures) : tree_(tree) {
    nodes_.resize(tree.nodes().size()), dofs_.resize(tree.n_v());
    masses_.reserve(nodes_.size());
    for (const TreeNode& n : tree.nodes()) {
      const Mat3& J = system.slot(n.slot).J;
      masses_.push_back({system.slot(n.slot).mass, {J(0, 0), J(1, 0), J(2, 0), J(1, 1), J(2, 1), J(2, 2)}});
    }
    const std::vector<InwardPlace> places = inward_places(tree.nodes(), n_waiting_);
    for (std::size_t k = 0; k < places.size(); ++k) nodes_[k].place = places[k];
    if (!has_closures) return;
    for (const TreeNode& n : tree.nodes()) {
      const Slot& slot = system.slot(n.slot);
      inverse_mass_.push_back(1.0 / slot.mass);
      inverse_J_.push_back(slot.freedoms == Freedoms::particle ? Mat3(Mat3::Zero()) : Mat3(slot.J.inverse()));
    }
  }

  std::size_t size() const { return nodes_.size(); }
  int parent(std::size_t k) const { return tree_.nodes()[k].parent; }
  int first_v(std::size_t k) const { return tree_.nodes()[k].first_v; }
  const InwardPlace& place(std::size_t k) const { return nodes_[k].place; }
  std::size_t n_waiting() const { return n_waiting_; }
  template <class F>
  LOCKSTEP_INLINE void with_joint(std::size_t k, F&& f) {
    const TreeNode& n = tree_.nodes()[k];
    const Node& b = nodes_[k];
    bodies::Coordinate<Space>* dof = dofs_.data() + n.first_v;
    const int n_v = n.n_v();
    if (n_v == 0) return f(bodies::JointPasses<Space, 0>{dof, 0, b.r, b.c});  // a weld that was kept
    for_size<1, 6>(
        n_v, [&](auto count) __attribute__((always_inline)) {
          f(bodies::JointPasses<Space, count>{dof, count, b.r, b.c});
        });
  }

  LOCKSTEP_INLINE void outward(const State& y, std::vector<Motion>& motions) {
    motions.resize(nodes_.size() + 1);
    const Vec3 still = Vec3::Zero();
    SinCosAhead half;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      half.see(
          k, nodes_.size(), [&](std::size_t i) __attribute__((always_inline)) {
            return half_angle(tree_.nodes()[i], y.q.data() + tree_.nodes()[i].first_q);
          });
      if (nodes_.size() > kCached && k + kAhead < nodes_.size())
        ask_for<1>(&motions[tree_.nodes()[k + kAhead].slot + 1], sizeof(Motion));
      const TreeNode& n = tree_.nodes()[k];
      const bool root = n.parent < 0;
      const std::size_t parent = std::max(n.parent, 0);
      const Motion& p = motions[root ? 0 : static_cast<std::size_t>(tree_.nodes()[parent].slot + 1)];
      const Vec3& wp = root ? still : nodes_[parent].w;
      Motion& own = motions[n.slot + 1];
      Node& b = nodes_[k];
      if (n.moving) {
        outward_moving(n, y, p, wp, own, b);
        continue;
      }
      Imposed now;
      if (n.imposed) laws_at(n, y.t, y.s, now);
      const NodeJoint joint{n, now};
      const NodeMotion motion = motion_of(joint, y);
      const Carried<Vec3> c = carry(motion, half.cosine(), half.sine(), p, wp, own);
      Vec3 ca, cal;
      motion.biases(c, p.A, own.A, wp, ca, cal);
      b.w = c.w, b.r = column(c.d1 + c.d2), b.c = {column(ca), column(cal)};
      bodies::put_axes(n.n_slides, n.n_v(), c, c.d2, dofs_.data() + n.first_v);
    }
  }
  /// M = m 1, H = 0, I = A J A', p = -f
  LOCKSTEP_INLINE void add_slot(std::size_t k, std::span<const Motion> motions, const VecX& forces,
                                Space::Inertia& IA) const {
    if (nodes_.size() > kCached && k >= kAhead) {
      const int slot = tree_.nodes()[k - kAhead].slot;
      ask_for<0>(&motions[slot + 1].A, sizeof(Mat3));
      ask_for<0>(forces.data() + 6 * slot, 6 * sizeof(double));
    }
    const int slot = tree_.nodes()[k].slot;
    const Motion& motion = motions[slot + 1];
    const double* f = forces.data() + 6 * slot;
    const auto& [m, J] = masses_[k];
    const Columns A = columns(motion.A);
    const Columns AJ{{A.c[0] * J[0] + A.c[1] * J[1] + A.c[2] * J[2], A.c[0] * J[1] + A.c[1] * J[3] + A.c[2] * J[4],
                      A.c[0] * J[2] + A.c[1] * J[4] + A.c[2] * J[5]}};
    for (int i = 0; i < 3; ++i) {
      IA.M.c[i][i] += m;
      IA.I.c[i] += AJ * motion.A.row(i);
    }
    IA.p.f -= Column{f[0], f[1], f[2], 0.0};
    IA.p.t -= A.c[0] * f[3] + A.c[1] * f[4] + A.c[2] * f[5];
  }

  const Twist& found(std::size_t k) const { return nodes_[k].found; }
  const Twist& centre(std::size_t k) const { return nodes_[k].found; }
  LOCKSTEP_INLINE const Twist& put(std::size_t k, const Twist& found) { return nodes_[k].found = found; }
  Twist read(std::size_t k, std::span<const Motion> motions, const VecX& a) const {
    const int slot = tree_.nodes()[k].slot;
    return {column(a.segment<3>(6 * slot)), column(motions[slot + 1].A * a.segment<3>(6 * slot + 3))};
  }
  void write(std::size_t k, std::span<const Motion> motions, VecX& a) const {
    const int slot = tree_.nodes()[k].slot;
    a.segment<3>(6 * slot) = vector(nodes_[k].found.a);
    a.segment<3>(6 * slot + 3) = motions[slot + 1].A.transpose() * vector(nodes_[k].found.al);
  }

  LOCKSTEP_INLINE Space::Wrench read_side(const RowView& rows, int i, int k, std::size_t node, const Motion& motion,
                                          double& diagonal) const {
    const std::array<double, 6> J = rows.J(i, k);
    const Vec3 f(J[0], J[1], J[2]), t(J[3], J[4], J[5]);
    diagonal += inverse_mass_[node] * f.squaredNorm() + t.dot(inverse_J_[node] * t);
    return {column(f), column(motion.A * t)};
  }
  double move_to_joint(std::size_t, Space::Wrench&) const { return 0; }  // it is the centre of mass

 private:
  struct alignas(64) Node {  // three cache lines
    Column r;                // from the parent's centre of mass
    Twist c, found;
    Vec3 w = Vec3::Zero();  // world axes
    InwardPlace place;
  };
  // Of a slot alone, slot axes: J by its columns from the diagonal on.
  struct Mass {
    double m, J[6];
  };

  // The same of a node with moving markers: rare, and apart from the loop.
  [[gnu::noinline]] void outward_moving(const TreeNode& n, const State& y, const Motion& p, const Vec3& wp, Motion& own,
                                        Node& b) {
    const MovedNode c = carry_moving(n, y, p, wp, own);
    b.w = c.w, b.r = column(c.r), b.c = {column(c.ca), column(c.cal)};
    bodies::put_axes(n.n_slides, n.n_v(), c.at, Vec3(c.r - c.at.X), dofs_.data() + n.first_v);
  }

  const JointTree& tree_;
  std::vector<Mass> masses_;  // by node
  std::vector<Node> nodes_;
  std::vector<bodies::Coordinate<Space>> dofs_;
  std::vector<double> inverse_mass_;  // by node, where there are closures;
  std::vector<Mat3> inverse_J_;       // slot axes
  std::size_t n_waiting_ = 0;
};

}  // namespace

std::unique_ptr<TreeRecursion> recursion_in_space(std::shared_ptr<const JointTree> tree, const System& system,
                                                  ClosureFronts closures) {
  return std::make_unique<RecursionIn<SpatialSlots>>(std::move(tree), system, std::move(closures));
}

}  // namespace lockstep
