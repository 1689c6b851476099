// SPDX-License-Identifier: BSD-3-Clause
// States along a tree: motions, rates, variations, and coordinates that are read off. How it is grown: joint_tree.cpp.
#include <boost/container/small_vector.hpp>

#include <algorithm>
#include <cmath>
#include <span>

#include <lockstep/author/lock.h>
#include "framework/dynamics/tree/joint_tree.h"
#include "framework/dynamics/tree/moving_markers.h"
#include "framework/dynamics/tree/tree_motion.h"
#include "framework/foundation/math/sin_cos.h"
#include "framework/foundation/support/clones.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

void JointTree::motions(const State& y, std::span<Motion> out) const {
  planar_ ? planar_->motions(nodes_, y, out) : carry_all(y, out);
}

LOCKSTEP_FLAT_CLONES void JointTree::carry_all(const State& y, std::span<Motion> out) const {
  SinCosAhead half;
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    half.see(
        k, nodes_.size(), [&](std::size_t i) __attribute__((always_inline)) {
          return half_angle(nodes_[i], y.q.data() + nodes_[i].first_q);
        });
    const TreeNode& node = nodes_[k];
    const Motion& p = out[motion_of(node.parent)];
    if (node.moving) {
      carry_moving(node, y, p, p.A * p.w, out[motion_of(node)]);
      continue;
    }
    Imposed now;
    if (node.imposed) laws_at(node, y.t, y.s, now);
    const NodeJoint joint{node, now};
    carry(lockstep::motion_of(joint, y), half.cosine(), half.sine(), p, p.A * p.w, out[motion_of(node)]);
  }
}

void laws_at(const TreeNode& n, double t, const VecX& s, Imposed& now) {
  const std::span<const double> own = n.own_states(s);
  ImposedTranslation x;
  ImposedRotation D;
  named(*n.lock, t, [&] { x = n.imposed->translation(t, own), D = n.imposed->rotation(t, own); });
  if (!(x.p + x.pd + x.pdd + D.w + D.a + D.q.vec()).allFinite()) refuse_laws(*n.lock, t);
  const double sign = n.reversed ? -1.0 : 1.0;
  const Mat3 S = rotation(n.reversed ? n.far_q : n.near_q), SD = S * D.A;
  now.p.setZero(), now.pd.setZero(), now.pdd.setZero();
  for (int k = 0; k < 3; ++k)  // on a free axis the law holds nothing
    if (includes(n.rows, row_bit(k)))
      now.p += sign * x.p[k] * S.col(k), now.pd += sign * x.pd[k] * S.col(k), now.pdd += sign * x.pdd[k] * S.col(k);
  now.q = D.q;
  now.w = sign * (SD * D.w), now.a = sign * (SD * D.a);
  now.axis = n.reversed ? n.axis : Vec3(SD * n.hinge);
}

Motion JointTree::motion(const State& y, int slot) const {
  boost::container::small_vector<const TreeNode*, 64> path;
  for (int k = node_of_[slot]; k >= 0; k = path.back()->parent) path.push_back(&nodes_[k]);
  Motion p, own;
  for (; !path.empty(); path.pop_back(), p = own)
    if (path.back()->moving)
      carry_moving(*path.back(), y, p, p.A * p.w, own);
    else
      carry(*path.back(), y, p, p.A * p.w, own);
  return p;
}

// d/dt of translations and angles are the velocities; e' = (1/2) e w (1.8).
void JointTree::kinematic_rate(const State& y, VecX& qd) const {
  qd.resize(n_q_);
  if (n_q_ == n_v_) {  // no ball: each coordinate has a velocity of its own
    std::copy_n(y.v.data(), n_v_, qd.data());
    return;
  }
  for (const TreeNode& node : nodes_) {
    const double* v = y.v.data() + node.first_v;
    double* d = qd.data() + node.first_q;
    const int n = node.n_slides + (node.turn == TreeTurn::hinge ? 1 : 0);
    for (int k = 0; k < n; ++k) d[k] = v[k];
    if (node.turn != TreeTurn::ball) continue;
    const double* q = y.q.data() + node.first_q + n;
    const Quat r = rate(Quat{q[0], q[1], q[2], q[3]}, Vec3(v[n], v[n + 1], v[n + 2]));
    d[n] = r.w, d[n + 1] = r.x, d[n + 2] = r.y, d[n + 3] = r.z;
  }
}

void JointTree::advance(State& y, double h, const VecX& v) const {
  for (const TreeNode& node : nodes_) {
    const double* u = v.data() + node.first_v;
    double* q = y.q.data() + node.first_q;
    const int n = node.n_slides + (node.turn == TreeTurn::hinge ? 1 : 0);
    for (int k = 0; k < n; ++k) q[k] += h * u[k];
    if (node.turn != TreeTurn::ball) continue;
    const Quat e = Quat{q[n], q[n + 1], q[n + 2], q[n + 3]} * exponential(h * Vec3(u[n], u[n + 1], u[n + 2]));
    q[n] = e.w, q[n + 1] = e.x, q[n + 2] = e.y, q[n + 3] = e.z;
  }
}

void JointTree::normalize(State& y) const {
  for (const TreeNode& node : nodes_)
    if (node.turn == TreeTurn::ball) y.q.segment<4>(node.first_q + node.n_slides).normalize();
}

bool shed_turns(double& angle) {
  constexpr double kMost = 1000 * kTwoPi, kTwoTurns = 2 * kTwoPi,
                   kLow = 4.8985871965894128e-16;  // 4 pi less kTwoTurns
  if (!(std::abs(angle) > kMost)) return false;
  const double n = std::round(angle / kTwoTurns);
  angle = std::fma(-n, kTwoTurns, angle) - n * kLow;
  return true;
}

bool JointTree::take_off_turns(State& y) const {
  bool any = false;
  for (const TreeNode& node : nodes_)
    if (node.turn == TreeTurn::hinge && shed_turns(y.q[node.first_q + node.n_slides])) any = true;
  return any;
}

namespace {

NodeVariation vary_node(const TreeNode& n, const State& y, const StateRate& d, const Motion& p, const Motion& own,
                        const NodeVariation& dp) {
  Imposed now;
  if (n.imposed) laws_at(n, y.t, y.s, now);
  const NodeJoint joint{n, now};
  return motion_of(joint, y).vary(p.A, own.A, p.A * p.w, d.q.data() + n.first_q, d.v.data() + n.first_v, dp);
}

// Writes the coordinates of a turn r, with the rates of its axes; an angle within half a revolution of that of `near`,
// or without one as the sign of r has it.
void write_turn(const TreeNode& node, const Quat& r, const Vec3& rates, const State* near, State& out) {
  const int at_q = node.first_q + node.n_slides, at_v = node.first_v + node.n_slides;
  if (node.turn == TreeTurn::hinge) {
    const double angle = 2.0 * std::atan2(r.vec().dot(node.hinge), r.w);
    out.q[at_q] = near ? angle + kTwoPi * std::round((near->q[at_q] - angle) / kTwoPi) : angle;
    out.v[at_v] = rates[0];
  } else if (node.turn == TreeTurn::ball) {
    out.q.segment<4>(at_q) = r.coefficients();
    out.v.segment<3>(at_v) = rates;
  }
}

}  // namespace

void JointTree::variations(const State& y, std::span<const Motion> at, const StateRate& d, VecX& dx, VecX& dv) const {
  const auto n = static_cast<Eigen::Index>(nodes_.size());
  dx.resize(6 * n), dv.resize(6 * n);
  for (const TreeNode& node : nodes_) {
    NodeVariation p{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    if (node.parent >= 0) {
      const int slot = nodes_[node.parent].slot;
      p = {dx.segment<3>(6 * slot), dx.segment<3>(6 * slot + 3), dv.segment<3>(6 * slot), dv.segment<3>(6 * slot + 3)};
    }
    const Motion& parent = at[motion_of(node.parent)];
    const NodeVariation own =
        node.moving ? vary_moving(node, y, d, parent, p) : vary_node(node, y, d, parent, at[motion_of(node)], p);
    dx.segment<3>(6 * node.slot) = own.x, dx.segment<3>(6 * node.slot + 3) = own.phi;
    dv.segment<3>(6 * node.slot) = own.v, dv.segment<3>(6 * node.slot + 3) = own.w;
  }
}

// The pose of far seen from near: r and rho of P seen from S, or their inverse.
void JointTree::read_off(const State& slots, const State* near, State& out) const {
  out.q.setZero(n_q_), out.v.setZero(n_v_);
  out.t = slots.t, out.s = slots.s, out.z = slots.z, out.modes = slots.modes, out.watched = slots.watched;
  for (const TreeNode& node : nodes_) {
    Motion p;
    if (node.parent >= 0) p = slot_motion(slots, nodes_[node.parent].slot);
    const Motion own = slot_motion(slots, node.slot);
    const Vec3 wp = p.A * p.w, w = own.A * own.w;
    double *q = out.q.data() + node.first_q, *v = out.v.data() + node.first_v;
    if (node.moving) {
      const MovedCoordinates c = read_moving(node, slots.t, slots.s, p, own);
      for (int i = 0, k = 0; i < 3; ++i)
        if (!includes(node.rows, row_bit(i))) q[k] = c.rho[i], v[k++] = c.rhod[i];
      write_turn(node, c.r, node.turn == TreeTurn::hinge ? Vec3(Vec3::Constant(node.hinge.dot(c.w))) : c.w, near, out);
      continue;
    }
    // The joint acts at the point X of the marker on the slot that does not carry the slides.
    const Vec3 X = node.reversed ? Vec3(p.x + p.A * node.near_u) : Vec3(own.x + own.A * node.far_u);
    const Motion& S = node.reversed ? own : p;
    const Vec3 S_origin = S.x + S.A * (node.reversed ? node.far_u : node.near_u);
    const Vec3 rho = (node.reversed ? -1.0 : 1.0) * (S.A.transpose() * (X - S_origin));
    const Vec3 v_own = own.v + cross(w, Vec3(X - own.x)), v_parent = p.v + cross(wp, Vec3(X - p.x));
    const Vec3 rhod = S.A.transpose() * (v_own - v_parent);
    for (int k = 0; k < node.n_slides; ++k) {
      const Vec3& e = node.slide(k);
      q[k] = e.dot(rho), v[k] = e.dot(rhod);
    }
    // e = e_p near r far' or e_p near r' far'
    Quat r = conjugate(node.near_q) * (conjugate(p.e) * own.e) * node.far_q;
    if (node.reversed) r = conjugate(r);
    Imposed now;
    if (node.imposed) laws_at(node, slots.t, slots.s, now), r = conjugate(now.q) * r;
    const NodeJoint joint{node, now};
    const Carried<Vec3> c = lockstep::motion_of(joint, out).carried(p.A, own.A, wp);
    const Vec3 turned = w - wp - (node.imposed ? c.law : Vec3(Vec3::Zero()));
    Vec3 rates = Vec3::Zero();
    for (int k = 0; k < node.n_v() - node.n_slides; ++k) rates[k] = c.turns[k].dot(turned);
    write_turn(node, r, rates, near, out);
  }
}

}  // namespace lockstep
