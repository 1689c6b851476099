#include "framework/dynamics/tree/articulated.h"

#include <algorithm>

#include <Eigen/LU>

#include "framework/dynamics/tree/column_algebra.h"
#include "framework/dynamics/tree/moving_markers.h"
#include "framework/dynamics/tree/recursion_of.h"
#include "framework/dynamics/tree/tree_motion.h"
#include "framework/foundation/math/for_size.h"
#include "framework/foundation/math/sin_cos.h"

namespace lockstep {

namespace {

constexpr std::size_t kAhead = 8;      // nodes
constexpr std::size_t kCached = 4096;  // nodes: what fewer take is in the cache anyway

// Slots may be numbered in another order than nodes: what a pass will read or write of a slot is asked for ahead.
template <int kWrites, class T>
LOCKSTEP_INLINE void ask_for(const T* first, std::size_t bytes) {
  for (std::size_t at = 0; at < bytes; at += 64) __builtin_prefetch(reinterpret_cast<const char*>(first) + at, kWrites);
}

}  // namespace

ArticulatedBodies::ArticulatedBodies(const JointTree& tree, const System& system, bool has_closures) {
  const std::size_t n = tree.nodes().size();
  nodes_.assign(n, Node());
  dofs_.resize(static_cast<std::size_t>(tree.n_v()));
  masses_.reserve(n);
  for (const TreeNode& t : tree.nodes()) {
    const Mat3& J = system.slot(t.slot).J;
    masses_.push_back({system.slot(t.slot).mass, {J(0, 0), J(1, 0), J(2, 0), J(1, 1), J(2, 1), J(2, 2)}});
  }

  // Nodes stand depth first: from the last to the first, who waits longest is asked for last.
  std::vector<int> stack;  // nodes whose children have passed something on
  std::size_t deepest = 0;
  for (std::size_t k = n; k-- > 0;) {
    Node& b = nodes_[k];
    if (!stack.empty() && stack.back() == static_cast<int>(k)) stack.pop_back(), b.own = static_cast<int>(stack.size());
    const int parent = tree.nodes()[k].parent;
    if (parent < 0) continue;
    const bool first = stack.empty() || stack.back() != parent;
    if (first) stack.push_back(parent);
    b.to = static_cast<int>(stack.size()) - 1;
    if (first) b.to = ~b.to;
    deepest = std::max(deepest, stack.size());
  }
  waiting_.resize(deepest);

  if (!has_closures) return;
  for (const TreeNode& t : tree.nodes()) {
    const Slot& slot = system.slot(t.slot);
    inverse_mass_.push_back(1.0 / slot.mass);
    inverse_J_.push_back(slot.freedoms == Freedoms::particle ? Mat3(Mat3::Zero()) : Mat3(slot.J.inverse()));
  }
}

LOCKSTEP_FLAT_CLONES void ArticulatedBodies::outward(const JointTree& tree, const State& y,
                                                     std::vector<Motion>& motions) {
  motions.resize(nodes_.size() + 1);
  const Vec3 still = Vec3::Zero();
  SinCosAhead half;
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    half.see(
        k, nodes_.size(), [&](std::size_t i) __attribute__((always_inline)) {
          return half_angle(tree.nodes()[i], y.q.data() + tree.nodes()[i].first_q);
        });
    if (nodes_.size() > kCached && k + kAhead < nodes_.size())
      ask_for<1>(&motions[static_cast<std::size_t>(tree.nodes()[k + kAhead].slot + 1)], sizeof(Motion));
    const TreeNode& n = tree.nodes()[k];
    const bool root = n.parent < 0;
    const std::size_t parent = static_cast<std::size_t>(std::max(n.parent, 0));
    const Motion& p = motions[root ? 0 : static_cast<std::size_t>(tree.nodes()[parent].slot + 1)];
    const Vec3& wp = root ? still : nodes_[parent].w;
    Motion& own = motions[static_cast<std::size_t>(n.slot + 1)];
    Node& b = nodes_[k];
    if (n.moving) {
      outward_moving(n, y, p, wp, own, b);
      continue;
    }
    Imposed now;
    if (n.imposed) laws_at(n, y.t, y.s, now);
    const Carried c = carry(n, now, y, {half.cosine(), half.sine()}, p, wp, own);
    b.w = c.w;
    b.r = column(c.d1 + c.d2);
    // al = al_p + cal,  a = a_p + al_p x r + ca
    Vec3 cal = cross(wp, c.turn);
    if (n.imposed)
      cal +=
          slide_axes(n, p, own) * now.a + cross(wp, c.law) + (n.reversed ? cross(c.turn, c.law) : cross(c.law, c.turn));
    Vec3 ca = cross(wp, cross(wp, c.d1)) + cross(c.w, cross(c.w, c.d2)) + cross(cal, c.d2);
    if (n.n_slides > 0 || n.imposed) ca += 2.0 * cross(n.reversed ? c.w : wp, c.slide);
    if (n.imposed) ca += slide_axes(n, p, own) * now.pdd;
    b.cal = column(cal), b.ca = column(ca);
    Dof* dof = dofs_.data() + n.first_v;
    for (int i = 0; i < n.n_slides; ++i, ++dof)
      dof->l = column(slide_axes(n, p, own) * n.slide(i)), dof->n = Column{};
    for (int i = 0; i < n.n_v() - n.n_slides; ++i, ++dof) {
      const Vec3 axis = c.turn_axes.col(i);
      dof->n = column(axis), dof->l = column(cross(axis, c.d2));
    }
  }
}

// The same of a node with moving markers: rare, and apart from the loop.
void ArticulatedBodies::outward_moving(const TreeNode& n, const State& y, const Motion& p, const Vec3& wp, Motion& own,
                                       Node& b) {
  const MovedNode c = carry_moving(n, y, p, wp, own);
  b.w = c.w, b.r = column(c.r), b.cal = column(c.cal), b.ca = column(c.ca);
  Dof* dof = dofs_.data() + n.first_v;
  for (int i = 0; i < n.n_slides; ++i, ++dof) dof->l = column(c.slide[static_cast<std::size_t>(i)]), dof->n = Column{};
  for (int i = 0; i < n.n_v() - n.n_slides; ++i, ++dof) {
    const Vec3 axis = c.turn_axes.col(i);
    dof->n = column(axis), dof->l = column(cross(axis, Vec3(own.x - c.X)));
  }
}

LOCKSTEP_INLINE void ArticulatedBodies::Inertia::add(const Inertia& b) {
  for (int k = 0; k < 3; ++k) M.c[k] += b.M.c[k], H.c[k] += b.H.c[k], H_t.c[k] += b.H_t.c[k], I.c[k] += b.I.c[k];
  pf += b.pf, pt += b.pt;
}

LOCKSTEP_INLINE void ArticulatedBodies::Inertia::add_row(const SpatialWrench& K, double l, double d_1) {
  const Column f = K.f * -d_1, t = K.t * -d_1;
  subtract_dyad(M, f, K.f), subtract_dyad(H, f, K.t);
  subtract_dyad(H_t, t, K.f), subtract_dyad(I, t, K.t);
  pf -= f * l, pt -= t * l;
}

// Of a slot and what its children have passed on: M = m 1, H = 0, I = A J A', p = -f.
LOCKSTEP_INLINE ArticulatedBodies::Inertia ArticulatedBodies::inertia_of(std::size_t node, const Motion& motion,
                                                                         const double* f) const {
  const Node& b = nodes_[node];
  const auto& [m, J] = masses_[node];
  const Columns A = columns(motion.A);
  const Columns AJ{{A.c[0] * J[0] + A.c[1] * J[1] + A.c[2] * J[2], A.c[0] * J[1] + A.c[1] * J[3] + A.c[2] * J[4],
                    A.c[0] * J[2] + A.c[1] * J[4] + A.c[2] * J[5]}};
  Inertia I = b.own < 0 ? Inertia{} : waiting_[static_cast<std::size_t>(b.own)];
  for (int k = 0; k < 3; ++k) {
    I.M.c[k][k] += m;
    I.I.c[k] += AJ * motion.A.row(k);
  }
  I.pf -= Column{f[0], f[1], f[2], 0.0};
  I.pt -= A.c[0] * f[3] + A.c[1] * f[4] + A.c[2] * f[5];
  return I;
}

// U = IA S, D = S' U, u = -S' p, then IA <- IA - U D^-1 U', p <- p + U D^-1 u
template <int k>
LOCKSTEP_INLINE void ArticulatedBodies::eliminate(const TreeNode& n, const Node& b, Inertia& I) {
  Dof* dof = dofs_.data() + n.first_v;
  for (int i = 0; i < k; ++i, ++dof) {
    dof->Uf = I.M * dof->l + I.H * dof->n;
    dof->Ut = I.H_t * dof->l + I.I * dof->n;
    dof->u = -dot(dof->l, I.pf) - dot(dof->n, I.pt);
    dof->D_1 = 1.0 / (dot(dof->l, dof->Uf) + dot(dof->n, dof->Ut));
    if (i + 1 == k && b.to == kRoot) return;
    const Column Vf = dof->Uf * dof->D_1, Vt = dof->Ut * dof->D_1;
    subtract_dyad(I.M, Vf, dof->Uf), subtract_dyad(I.H, Vf, dof->Ut);
    subtract_dyad(I.H_t, Vt, dof->Uf), subtract_dyad(I.I, Vt, dof->Ut);
    I.pf += Vf * dof->u, I.pt += Vt * dof->u;
  }
}

namespace {

// p <- p + IA c, then all about the parent's mass centre: X' IA X and X' p with X = [1 -r~; 0 1].
template <class N, class I>
LOCKSTEP_INLINE void shift(const N& b, I& IA) {
  IA.pf += IA.M * b.ca + IA.H * b.cal;
  IA.pt += IA.H_t * b.ca + IA.I * b.cal;
  const Skew r(b.r);
  subtract_product(IA.I, IA.H_t, r);
  subtract_product(IA.H, IA.M, r);
  add_product(IA.I, r, IA.H);
  add_product(IA.H_t, r, IA.M);
  IA.pt += r * IA.pf;
}

}  // namespace

// vd = D^-1 (u - U' a') - less, a' = (a_p + al_p x r + ca, al_p + cal), from the parent's side on; less: V' lambda of
// closures, null without
template <int k>
LOCKSTEP_INLINE void ArticulatedBodies::solve(const TreeNode& n, Node& b, VecX& vd, const double* less) {
  const Dof* dof = dofs_.data() + n.first_v;
  SpatialTwist& own = b.found;
  for (int i = k; i-- > 0;) {
    const double x = dof[i].D_1 * (dof[i].u - dot(dof[i].Uf, own.a) - dot(dof[i].Ut, own.al)) - (less ? less[i] : 0.0);
    vd[n.first_v + i] = x;
    own.a += dof[i].l * x, own.al += dof[i].n * x;
  }
}

LOCKSTEP_INLINE SpatialWrench& operator+=(SpatialWrench& a, const SpatialWrench& b) {
  a.f += b.f, a.t += b.t;
  return a;
}
LOCKSTEP_INLINE SpatialWrench& operator-=(SpatialWrench& a, const SpatialWrench& b) {
  a.f -= b.f, a.t -= b.t;
  return a;
}
LOCKSTEP_INLINE SpatialWrench operator*(double x, const SpatialWrench& a) { return {a.f * x, a.t * x}; }
LOCKSTEP_INLINE double dot(const SpatialWrench& a, const SpatialTwist& b) { return dot(a.f, b.a) + dot(a.t, b.al); }
LOCKSTEP_INLINE double force2(const SpatialWrench& a) { return dot(a.f, a.f); }
LOCKSTEP_INLINE double moment2(const SpatialWrench& a) { return dot(a.t, a.t); }
LOCKSTEP_INLINE double linear2(const SpatialTwist& a) { return dot(a.a, a.a); }
LOCKSTEP_INLINE double angular2(const SpatialTwist& a) { return dot(a.al, a.al); }

LOCKSTEP_INLINE ArticulatedBodies::Joint ArticulatedBodies::joint(const JointTree& tree, std::size_t k) const {
  const TreeNode& n = tree.nodes()[k];
  return {nodes_[k], dofs_.data() + n.first_v, n.n_v()};
}

LOCKSTEP_INLINE void ArticulatedBodies::Joint::pass(SpatialWrench& K, double& l, double* kappa, double* V) const {
  for (int x = 0; x < n_v; ++x) {
    kappa[x] = dot(K.f, dof[x].l) + dot(K.t, dof[x].n);
    V[x] = kappa[x] * dof[x].D_1;
    K.f -= dof[x].Uf * V[x], K.t -= dof[x].Ut * V[x], l += V[x] * dof[x].u;
  }
  l += dot(K.f, b.ca) + dot(K.t, b.cal);
  K.t += Skew(b.r) * K.f;
}

// u = -S' p, p <- p + U D^-1 u, then about the parent's mass centre
LOCKSTEP_INLINE void ArticulatedBodies::Joint::pass_again(SpatialWrench& p, double* u) const {
  for (int x = 0; x < n_v; ++x) {
    u[x] = -dot(dof[x].l, p.f) - dot(dof[x].n, p.t);
    const double y = dof[x].D_1 * u[x];
    p.f += dof[x].Uf * y, p.t += dof[x].Ut * y;
  }
  p.t += Skew(b.r) * p.f;
}

LOCKSTEP_INLINE SpatialTwist ArticulatedBodies::Joint::solve_again(const SpatialTwist& p, const double* u,
                                                                   const double* less, double* dv) const {
  SpatialTwist own{p.a - Skew(b.r) * p.al, p.al};
  for (int x = n_v; x-- > 0;) {
    dv[x] = dof[x].D_1 * (u[x] - dot(dof[x].Uf, own.a) - dot(dof[x].Ut, own.al)) - (less ? less[x] : 0.0);
    own.a += dof[x].l * dv[x], own.al += dof[x].n * dv[x];
  }
  return own;
}

LOCKSTEP_INLINE SpatialWrench ArticulatedBodies::read_side(const RowView& rows, int i, int k, std::size_t node,
                                                           const Motion& motion, double& diagonal) const {
  const std::array<double, 6> J = rows.J(i, k);
  const Vec3 f(J[0], J[1], J[2]), t(J[3], J[4], J[5]);
  diagonal += inverse_mass_[node] * f.squaredNorm() + t.dot(inverse_J_[node] * t);
  return {column(f), column(motion.A * t)};
}

// a = a_p + al_p x r + ca, al = al_p + cal: where the coordinates' own are zero
LOCKSTEP_INLINE SpatialTwist ArticulatedBodies::carried(const TreeNode& n, const Node& b) const {
  SpatialTwist own{b.ca, b.cal};
  if (n.parent < 0) return own;
  const SpatialTwist& p = nodes_[static_cast<std::size_t>(n.parent)].found;
  own.a += p.a - Skew(b.r) * p.al, own.al += p.al;
  return own;
}

template <class Rows>
LOCKSTEP_INLINE void ArticulatedBodies::accelerate_with(const JointTree& tree, std::span<const Motion> motions,
                                                        const VecX& f, Rows& rows, VecX& vd) {
  vd.resize(tree.n_v());
  for (std::size_t k = nodes_.size(); k-- > 0;) {
    if (nodes_.size() > kCached && k >= kAhead) {
      const int slot = tree.nodes()[k - kAhead].slot;
      ask_for<0>(&motions[static_cast<std::size_t>(slot + 1)].A, sizeof(Mat3));
      ask_for<0>(f.data() + 6 * slot, 6 * sizeof(double));
    }
    const TreeNode& n = tree.nodes()[k];
    const Node& b = nodes_[k];
    Inertia I = inertia_of(k, motions[static_cast<std::size_t>(n.slot + 1)], f.data() + 6 * n.slot);
    rows.close(k, I);
    if (n.n_v() > 0)  // else a weld that was kept
      for_size<1, 6>(n.n_v(), [&](auto count) __attribute__((always_inline)) {
        eliminate<count>(n, b, I);
        rows.pass_on(k, count, Joint{b, dofs_.data() + n.first_v, count});
      });
    else
      rows.pass_on(k, 0, joint(tree, k));
    if (b.to == kRoot) continue;
    shift(b, I);
    if (b.to < 0)
      waiting_[static_cast<std::size_t>(~b.to)] = I;
    else
      waiting_[static_cast<std::size_t>(b.to)].add(I);
  }
  rows.close_at_ground();
  Largest most;
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const TreeNode& n = tree.nodes()[k];
    Node& b = nodes_[k];
    SpatialTwist& own = b.found;
    own = carried(n, b);
    const double* less = rows.less(k, n.n_v());
    if (n.n_v() > 0)
      for_size<1, 6>(n.n_v(), [&](auto count) __attribute__((always_inline)) { solve<count>(n, b, vd, less); });
    rows.find(k, own);
    most.add(dot(own.a, own.a), dot(own.al, own.al));
  }
  largest_ = most;
}

void ArticulatedBodies::find_largest() {
  largest_ = {};
  for (const Node& b : nodes_) largest_.add(dot(b.found.a, b.found.a), dot(b.found.al, b.found.al));
}

LOCKSTEP_FLAT_CLONES void ArticulatedBodies::accelerate(const JointTree& tree, std::span<const Motion> motions,
                                                        const VecX& f, VecX& vd) {
  NoClosures none;
  accelerate_with(tree, motions, f, none, vd);
}

LOCKSTEP_FLAT_CLONES void ArticulatedBodies::accelerate(const JointTree& tree, std::span<const Motion> motions,
                                                        const VecX& f, Closures& closures, VecX& vd) {
  accelerate_with(tree, motions, f, closures, vd);
}

void ArticulatedBodies::follow(const JointTree& tree) {
  for (std::size_t k = 0; k < nodes_.size(); ++k) nodes_[k].found = carried(tree.nodes()[k], nodes_[k]);
  find_largest();
}

void ArticulatedBodies::add(const Closures& closures) {
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    SpatialTwist& own = nodes_[k].found;
    own.a += closures.change(k).a, own.al += closures.change(k).al;
  }
  find_largest();
}

void ArticulatedBodies::read_off(const JointTree& tree, std::span<const Motion> motions, const VecX& a, VecX& vd) {
  vd.resize(tree.n_v());
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const TreeNode& n = tree.nodes()[k];
    Node& b = nodes_[k];
    b.found.a = column(a.segment<3>(6 * n.slot));
    b.found.al = column(motions[static_cast<std::size_t>(n.slot + 1)].A * a.segment<3>(6 * n.slot + 3));
    Column da = b.found.a - b.ca, dal = b.found.al - b.cal;  // against the parent, beyond what the velocities make
    if (n.parent >= 0) {
      const SpatialTwist& p = nodes_[static_cast<std::size_t>(n.parent)].found;
      da -= p.a - Skew(b.r) * p.al, dal -= p.al;
    }
    const Dof* dof = dofs_.data() + n.first_v;
    for (int i = n.n_slides; i < n.n_v(); ++i) {
      const double x = dot(dof[i].n, dal);
      vd[n.first_v + i] = x;
      da -= dof[i].l * x;
    }
    for (int i = 0; i < n.n_slides; ++i) vd[n.first_v + i] = dot(dof[i].l, da);
  }
  find_largest();
}

void ArticulatedBodies::accelerations(const JointTree& tree, std::span<const Motion> motions, VecX& a) const {
  a.resize(6 * tree.n_slots());
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const int slot = tree.nodes()[k].slot;
    a.segment<3>(6 * slot) = vector(nodes_[k].found.a);
    a.segment<3>(6 * slot + 3) = motions[static_cast<std::size_t>(slot + 1)].A.transpose() * vector(nodes_[k].found.al);
  }
}

template class RecursionOf<ArticulatedBodies>;

}  // namespace lockstep
