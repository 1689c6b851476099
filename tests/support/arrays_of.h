// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// @file A mechanism in arrays of numbers (dynamics/tree/number_closures.h): its plans, and its numbers at a state.

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <span>
#include <vector>

#include <Eigen/LU>

#include <lockstep/author/lock.h>
#include <lockstep/body.h>
#include <lockstep/system.h>
#include "framework/dynamics/tree/closure_plan.h"
#include "framework/dynamics/tree/moving_markers.h"
#include "framework/dynamics/tree/tree_motion.h"

namespace lockstep::numbers {

class ArraysOf {
 public:
  using Array = std::span<double>;
  /// Of a system that is set up and moves in joint coordinates.
  explicit ArraysOf(System& system)
      : system_(system),
        layout_(lay_out_tree(system, system.start().modes, Taken::all)),
        plan(make_plan(layout_)),
        loops(make_closure_plan(system, layout_)) {
    lay_out();
    fill_joints();
    fill_closures();
  }
  ArraysOf(const ArraysOf&) = delete;

  /// The state, in joint coordinates, and what laws, forces and links with rows of their own give there.
  void see(const State& state, const Inputs& in) {
    for (Eigen::Index i = 0; i < state.q.size(); ++i) z.y[i] = state.q[i];
    for (Eigen::Index i = 0; i < state.v.size(); ++i) z.y[plan.n_q + i] = state.v[i];
    for (std::size_t k = 0; k < plan.nodes.size(); ++k)
      if (plan.nodes[k].has_law || plan.nodes[k].moving) see_laws(k, state);
    if (plan.normal >= 0) see_heights();
    see_forces(in);
    for (const Link& link : loops.masks) see_laws(link, in);
    for (const OwnRows& rows : loops.own) see_rows(rows, in);
  }

 private:
  System& system_;
  TreeLayout layout_;
  RowTable scratch_;
  std::deque<std::vector<double>> all_;

 public:
  const TreePlan plan;
  ClosurePlan loops;
  TreeArrays<Array> z{};
  ClosureArrays<Array> c{};

 private:
  const JointTree& tree() const { return *layout_.tree; }
  Array add(std::size_t n) { return all_.emplace_back(std::max<std::size_t>(n, 1), 0.0); }

  // ---------------------------------------------------------------------------------------------------- numbers in arrays

  template <class M>
  static void put(Array to, std::size_t at, const M& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) to[at + static_cast<std::size_t>(i)] = values.data()[i];
  }
  static void put_rows(Array to, std::size_t at, const Mat3& A) { put(to, at, Mat3(A.transpose())); }
  // In the order of the plan's axes.
  void put_axes(Array to, std::size_t at, const Vec3& a) const {
    for (std::size_t i = 0; i < 3; ++i) to[at + i] = a[plan.axes()[i]];
  }
  void put_axes(Array to, std::size_t at, const Quat& q) const { to[at] = q.w, put_axes(to, at + 1, Vec3(q.vec())); }
  void put_symmetric(Array to, std::size_t at, const Mat3& J) const {
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = i; j < 3; ++j) to[at++] = J(plan.axes()[i], plan.axes()[j]);
  }
  // A translation and its rates, and the turn q with its rates w and a.
  template <class Turn>
  static void put_carrying(Array to, std::size_t at, const Vec3& u, const Vec3& ud, const Vec3& udd, const Turn& turn) {
    put(to, at + marked::u, u), put(to, at + marked::ud, ud), put(to, at + marked::udd, udd);
    put(to, at + marked::q, turn.q.coefficients()), put(to, at + marked::w, turn.w), put(to, at + marked::a, turn.a);
  }

  // ------------------------------------------------------------------------------------------------------------- the tree

  void lay_out() {
    const std::size_t n = plan.nodes.size(), m = loops.n_rows();
    z.y = add(plan.n_q + plan.n_v), z.gravity = add(3), z.joint = add(joint::size * n), z.more = add(plan.size_more);
    z.law = add(plan.size_law), z.cosine = add(n), z.sine = add(n), z.moving = add(moving::size * (n + 1));
    if (!system_.forces().empty()) z.wrench = add(6 * n);
    c.rows.body = add(body::size * (loops.n_slots + 1)), c.rows.frames = add(loops.size_frames);
    c.rows.law = add(loops.size_law), c.rows.J = add(loops.size_J), c.inverse = add(7 * n),
    c.J = add(6 * loops.slots.size());
    c.l = add(loops.fronts.rows.size()), c.Lambda = add(static_cast<std::size_t>(loops.fronts.n_Lambda));
    c.V = add(static_cast<std::size_t>(loops.fronts.n_V));
    for (Array* of_rows : {&c.rows.c, &c.diagonal, &c.scale, &c.d, &c.lambda}) *of_rows = add(m);
  }

  void fill_joints() {
    const bool flat = plan.normal >= 0;
    std::ranges::fill(z.cosine, 1.0);  // of no angle
    put_axes(z.gravity, 0, system_.gravity());
    z.moving[moving::e] = 1, put_rows(z.moving, moving::A, Mat3::Identity());
    for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
      const NumberNode& n = plan.nodes[k];
      const TreeNode& t = tree().nodes()[k];
      const Slot& slot = system_.slot(t.slot);
      put_axes(z.joint, n.joint + joint::near, t.near_u), put_axes(z.joint, n.joint + joint::far, t.far_u);
      put_axes(z.joint, n.joint + joint::K0, t.K0), put_axes(z.joint, n.joint + joint::K1, t.K1);
      put_axes(z.joint, n.joint + joint::axis, t.axis);
      z.joint[n.joint + joint::m] = slot.mass, put_symmetric(z.joint, n.joint + joint::J, slot.J);
      z.moving[moving::size * (k + 1) + moving::A + 8] = 1;  // in a plane for good
      if (!n.needs_more()) continue;
      const TreeAxes axes = t.axes ? *t.axes : TreeAxes();
      for (std::size_t i = 0; i < 3; ++i) put_axes(z.more, n.more + more::slide + 3 * i, axes.slide[i]);
      put_rows(z.more, n.more + more::ball, axes.ball);
      // In a plane near' q r far'^-1 = (near q near^-1) (near r near^-1) K0, each of which turns about the normal.
      put_axes(z.more, n.more + more::near_q, flat ? Quat() : t.near_q);
      put_axes(z.more, n.more + more::far_q, flat ? conjugate(t.K0) : t.far_q);
      put_axes(z.more, n.more + more::hinge, flat ? Vec3(rotation(t.near_q) * t.hinge) : t.hinge);
    }
    if (flat) see_heights();
  }

  void see_laws(std::size_t k, const State& state) {
    const TreeNode& n = tree().nodes()[k];
    const std::size_t at = plan.nodes[k].law;
    if (n.moving) {
      const JointLaws now = joint_laws_at(n, state.t, state.s);
      put_carrying(z.law, at + marked::near, now.near.u, now.near.ud, now.near.udd, now.near);
      put_carrying(z.law, at + marked::far, now.far.u, now.far.ud, now.far.udd, now.far);
      return put_carrying(z.law, at + marked::lock, now.x.p, now.x.pd, now.x.pdd, now.D);
    }
    Imposed now;
    laws_at(n, state.t, state.s, now);
    put_axes(z.law, at + imposed::p, now.p), put_axes(z.law, at + imposed::pd, now.pd);
    put_axes(z.law, at + imposed::pdd, now.pdd), put_axes(z.law, at + imposed::w, now.w);
    put_axes(z.law, at + imposed::a, now.a), put_axes(z.law, at + imposed::axis, now.axis);
    put_axes(z.law, at + imposed::q, plan.normal < 0 ? now.q : n.near_q * now.q * conjugate(n.near_q));
  }

  // Of the centres of mass along the normal, where nothing moves: after the laws.
  void see_heights() {
    for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
      const NumberNode& n = plan.nodes[k];
      const auto height = [&](std::size_t slot) -> double& { return z.moving[moving::size * slot + moving::x + 2]; };
      height(k + 1) = height(static_cast<std::size_t>(n.parent + 1)) + z.joint[n.joint + joint::near + 2] -
                      z.joint[n.joint + joint::far + 2] + (n.has_law ? z.law[n.law + imposed::p + 2] : 0);
    }
  }

  void see_forces(const Inputs& in) {
    if (z.wrench.empty()) return;
    VecX wrench = VecX::Zero(6 * system_.n_slots());
    WrenchSum sum(in.motions, wrench);
    for (const auto& force : system_.forces()) force->apply(in, sum);
    for (Eigen::Index i = 0; i < wrench.size(); i += 3)
      put_axes(z.wrench, static_cast<std::size_t>(i), Vec3(wrench.segment<3>(i)));
  }

  // --------------------------------------------------------------------------------------------------------- the closures

  const MarkerLock& lock_in(const Link& link) const {
    return static_cast<const MarkerLock&>(*system_.links()[link.link]);
  }

  void fill_closures() {
    const std::size_t ground = body::size * loops.n_slots;
    put_rows(c.rows.body, ground + body::A, Mat3::Identity()), c.rows.body[ground + body::e] = 1;
    for (Link& link : loops.masks) {
      const MarkerFrame P(lock_in(link).p()), S(lock_in(link).s());
      if (link.turn == Turn::parallel && !(P.parallel() && S.parallel())) link.turn = Turn::plain;
      put(c.rows.frames, link.frames + frames::uP, P.u0), put(c.rows.frames, link.frames + frames::uS, S.u0);
      put(c.rows.frames, link.frames + frames::qP, P.q0.coefficients());
      put(c.rows.frames, link.frames + frames::qS, S.q0.coefficients());
      put_rows(c.rows.frames, link.frames + frames::AP, P.A0), put_rows(c.rows.frames, link.frames + frames::AS, S.A0);
    }
    for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
      const Slot& slot = system_.slot(plan.nodes[k].slot);
      c.inverse[7 * k] = 1 / slot.mass, put_symmetric(c.inverse, 7 * k + 1, inverse_inertia(slot, k));
    }
  }
  // J^-1 of the slot of node k, its own axes: in a plane about the normal alone, and zero for a particle.
  Mat3 inverse_inertia(const Slot& slot, std::size_t k) const {
    if (slot.freedoms == Freedoms::particle) return Mat3::Zero();
    if (plan.normal < 0) return slot.J.inverse();
    const Posture* posture = tree().planar()->posture(tree().planar()->nodes()[k]);
    const Vec3 n = posture ? posture->normal : Vec3(Vec3::Unit(plan.normal));
    return n * n.transpose() / n.dot(slot.J * n);
  }

  void see_laws(const Link& link, const Inputs& in) {
    if (link.moved) {
      const ImposedTranslation D = lock_in(link).imposed_translation(in);
      put(c.rows.law, link.law + law::p, D.p), put(c.rows.law, link.law + law::pd, D.pd);
      put(c.rows.law, link.law + law::pdd, D.pdd);
    }
    if (link.turn != Turn::law) return;
    const ImposedRotation D = lock_in(link).imposed_rotation(in);
    put(c.rows.law, link.law + law::q, D.q.coefficients()), put_rows(c.rows.law, link.law + law::A, D.A);
    put(c.rows.law, link.law + law::w, D.w), put(c.rows.law, link.law + law::a, D.a);
  }

  void see_rows(const OwnRows& rows, const Inputs& in) {
    const RowBlock block = gather_alone(*system_.links()[rows.link], in, scratch_);
    for (std::size_t k = 0; k < rows.m; ++k) {
      const int own = rows.own[k];
      c.rows.c[rows.first_row + k] = block.Qhat(own);
      for (std::size_t i = 0; i < rows.n_sides; ++i) {
        const std::array<double, 6> J = block.J(static_cast<int>(i), own);
        for (std::size_t x = 0; x < 6; ++x) c.rows.J[rows.J + (6 * i + x) * rows.m + k] = J[x];
      }
    }
  }
};

}  // namespace lockstep::numbers
