// SPDX-License-Identifier: BSD-3-Clause
// NumberTree: the recursion of a tree (recursion_in.h) on arrays of any numbers, in space or in a plane: its nodes, and how
// they move. World axes; forces and accelerations of a slot about its centre of mass.
#pragma once

#include "framework/dynamics/tree/joint_motion.h"
#include "framework/dynamics/tree/moving_frame.h"
#include "framework/dynamics/tree/recursion_in.h"
#include "framework/dynamics/tree/tree_plan.h"

namespace lockstep::numbers {

/// The joint of a node; its numbers are loaded where they are asked for. kHinge: it is_hinge().
template <bool kHinge, class G>
struct NumberJoint {
  using A = typename G::Array;
  using L = typename G::L;
  using W = typename G::W;
  using M3 = typename G::M3;
  using Q4 = typename G::Q4;
  static constexpr bool kBalls = !G::kFlat;
  const NumberNode& n;
  const A joint, more, law;

  LOCKSTEP_INLINE NumberJoint(const NumberNode& node, const TreeNumbers<G>& z)
      : n(node), joint(z.joint + n.joint), more(z.more + n.more), law(z.law + n.law) {}
  LOCKSTEP_INLINE int n_slides() const { return kHinge ? 0 : n.n_slides; }
  LOCKSTEP_INLINE TreeTurn turn() const { return kHinge ? TreeTurn::hinge : n.turn; }
  LOCKSTEP_INLINE bool reversed() const { return n.reversed; }
  LOCKSTEP_INLINE bool has_laws() const { return !kHinge && n.has_law; }
  LOCKSTEP_INLINE L near_u() const { return G::linear(joint, joint::near); }
  LOCKSTEP_INLINE L far_u() const { return G::linear(joint, joint::far); }
  LOCKSTEP_INLINE W axis() const { return has_laws() ? G::axial(law, imposed::axis) : G::axial(joint, joint::axis); }
  LOCKSTEP_INLINE Q4 K0() const { return G::quaternion(joint, joint::K0); }
  LOCKSTEP_INLINE Q4 K1() const { return G::quaternion(joint, joint::K1); }
  LOCKSTEP_INLINE Q4 near_q() const { return G::quaternion(more, more::near_q); }
  LOCKSTEP_INLINE Q4 far_q() const { return G::quaternion(more, more::far_q); }
  LOCKSTEP_INLINE W hinge() const { return G::axial(more, more::hinge); }
  LOCKSTEP_INLINE L slide(int i) const { return G::linear(more, more::slide + 3 * static_cast<std::size_t>(i)); }
  LOCKSTEP_INLINE int free_axis(int i) const { return n.slides[i]; }
  LOCKSTEP_INLINE W ball(int i) const {
    if constexpr (kBalls)
      return column_of(load9(more, more::ball), i);
    else
      return W{};
  }
  LOCKSTEP_INLINE L p() const { return G::linear(law, imposed::p); }
  LOCKSTEP_INLINE L pd() const { return G::linear(law, imposed::pd); }
  LOCKSTEP_INLINE L pdd() const { return G::linear(law, imposed::pdd); }
  LOCKSTEP_INLINE W w() const { return G::axial(law, imposed::w); }
  LOCKSTEP_INLINE W a() const { return G::axial(law, imposed::a); }
  LOCKSTEP_INLINE Q4 q() const { return G::quaternion(law, imposed::q); }
  LOCKSTEP_INLINE Q4 unit(const Q4& r) const { return (1.0 / bodies::square_root(norm2(r))) * r; }
};

/// From the parent to the slot, of a joint whose markers move on their bodies by laws.
template <class G, class A = typename G::Array>
LOCKSTEP_INLINE auto take_along(const NumberNode& n, const TreePlan& plan, const TreeNumbers<G>& z, std::size_t k,
                                MovingFrame<VectorIn<A>, MatrixIn<A>, QuaternionIn<A>, false>& f) {
  const NumberJoint<false, G> j(n, z);
  const auto carrying = [&](std::size_t at) __attribute__((always_inline))->Carrying<VectorIn<A>, QuaternionIn<A>> {
    const A p = j.law + at;
    return {load3(p, marked::u), load3(p, marked::ud), load3(p, marked::udd),
            load4(p, marked::q), load3(p, marked::w),  load3(p, marked::a)};
  };
  const auto lock = carrying(marked::lock);
  const A q = z.y + n.q, v = z.y + (plan.n_q + n.v);
  const auto own = own_motion<false>(j, lock, q, v, q, v, z.cosine[k], z.sine[k]);
  return lockstep::take_along(j, carrying(marked::near), carrying(marked::far), lock, own, f);
}

/// The Slots of the recursion. G: Spatial or Planar (number_arrays.h).
template <class G>
struct NumberTree {
  using Array = typename G::Array;
  using T = typename G::T;
  using L = typename G::L;
  using W = typename G::W;
  using M3 = typename G::M3;
  using Q4 = typename G::Q4;
  using Space = typename G::Space;
  using Twist = typename Space::Twist;
  using Inertia = typename Space::Inertia;
  template <bool kHinge>
  using Joint = NumberJoint<kHinge, G>;
  template <bool kHinge>
  using Motion = JointMotion<Joint<kHinge>, Array>;

  const TreePlan& plan;
  const TreeNumbers<G> z;

  /// The motion of a slot; -1: the ground.
  LOCKSTEP_INLINE Array moving_at(std::ptrdiff_t k) const {
    return z.moving + moving::size * static_cast<std::size_t>(k + 1);
  }
  template <bool kHinge>
  LOCKSTEP_INLINE Motion<kHinge> motion_of(const Joint<kHinge>& joint) const {
    return {joint, z.y + joint.n.q, z.y + (plan.n_q + joint.n.v)};
  }

  // ------------------------------------------------------------------------------------------------ first pass, outward

  LOCKSTEP_INLINE void outward() const {
    for (std::size_t k = 0; k < plan.nodes.size(); ++k) plan.nodes[k].is_hinge() ? carry<true>(k) : carry<false>(k);
  }
  /// Writes the motion of a node and the axes of its coordinates. kHinge: it is_hinge().
  template <bool kHinge>
  LOCKSTEP_INLINE void carry(std::size_t k) const {
    const NumberNode& n = plan.nodes[k];
    const Array p = moving_at(n.parent), b = moving_at(static_cast<std::ptrdiff_t>(k));
    const M3 A_p = G::matrix(p, moving::A);
    const W w_p = G::axial(p, moving::w);
    const auto put = [&](const Q4& e, const M3& A, const W& w, const L& r, const L& v, const L& ca, const W& cal)
        __attribute__((always_inline)) {
      z.travel[k] = {Space::from(r), {Space::from(ca), Space::from_axial(cal)}};
      store4(b, moving::e, e), store9(b, moving::A, A), store3(b, moving::w, w);
      store3(b, moving::x, G::linear(p, moving::x) + r), store3(b, moving::v, G::linear(p, moving::v) + v);
    };
    if constexpr (!kHinge && !G::kFlat) {
      if (n.moving) {
        MovingFrame<L, M3, Q4, false> f{G::quaternion(p, moving::e), A_p, w_p};
        const auto at = take_along<G>(n, plan, z, k, f);
        const Q4 e = near_unit(f.e);
        put(e, G::axes(e), f.w, f.x, f.v, f.a, f.al);
        return bodies::put_axes(n.n_slides, n.n_v(), at, L(f.x - at.X), z.dof + n.v);
      }
    }
    const Joint<kHinge> joint(n, z);
    const Motion<kHinge> m = motion_of(joint);
    const Q4 e = m.orientation(z.cosine[k], z.sine[k], G::quaternion(p, moving::e));
    const M3 A = G::axes(e);
    const Carried<L, W> c = m.carried(A_p, A, w_p);
    L ca;
    W cal;
    m.biases(c, A_p, A, w_p, ca, cal);
    put(e, A, c.w, c.d1 + c.d2, m.velocity(c, w_p), ca, cal);
    bodies::put_axes(joint.n_slides(), kHinge ? 1 : n.n_v(), c, c.d2, z.dof + n.v);
  }

  // ------------------------------------------------------------------------------------------- second and third pass

  LOCKSTEP_INLINE std::size_t size() const { return plan.nodes.size(); }
  LOCKSTEP_INLINE int parent(std::size_t k) const { return plan.nodes[k].parent; }
  LOCKSTEP_INLINE int first_v(std::size_t k) const { return static_cast<int>(plan.nodes[k].v); }
  LOCKSTEP_INLINE const InwardPlace& place(std::size_t k) const { return plan.nodes[k]; }
  template <class F>
  LOCKSTEP_INLINE void with_joint(std::size_t k, F&& f) const {
    const NumberNode& n = plan.nodes[k];
    f(bodies::JointPasses<Space>{z.dof + n.v, n.n_v(), z.travel[k].r, z.travel[k].c});
  }
  LOCKSTEP_INLINE Twist found(std::size_t k) const {
    const Array b = moving_at(static_cast<std::ptrdiff_t>(k));
    return {Space::from(G::linear(b, moving::a)), Space::from_axial(G::axial(b, moving::al))};
  }
  LOCKSTEP_INLINE const Twist& put(std::size_t k, const Twist& found) const {
    const Array b = moving_at(static_cast<std::ptrdiff_t>(k));
    if constexpr (G::kFlat)
      b[moving::a] = found.a.i, b[moving::a + 1] = found.a.j, b[moving::al + 2] = found.al;
    else
      store3(b, moving::a, found.a), store3(b, moving::al, found.al);
    return found;
  }
  /// Numbers that cannot be compared have no largest one.
  struct Largest {
    LOCKSTEP_INLINE void add(const T&, const T&) const {}
  };

  /// M = m 1, H = 0, I = A J A', p = (-m g - F, w x I w - T)
  LOCKSTEP_INLINE void add_slot(std::size_t k, const L& g, Inertia& IA) const {
    const NumberNode& n = plan.nodes[k];
    const Array b = moving_at(static_cast<std::ptrdiff_t>(k)), j = z.joint + n.joint;
    const T m = j[joint::m];
    IA.p.f = IA.p.f - Space::from(to<L>(m * g));
    if constexpr (G::kFlat) {
      IA.Mii += m, IA.Mjj += m, IA.I += j[joint::J + 5];
    } else {
      const W w = load3(b, moving::w);
      const auto I = bodies::Symmetric<T>::turned(load9(b, moving::A), load_symmetric(j, joint::J));
      IA.M.xx += m, IA.M.yy += m, IA.M.zz += m;
      IA.I = IA.I + I;
      IA.p.t = IA.p.t + cross(w, I * w);
    }
    if (!z.wrench) return;
    const Array F = z.wrench + 6 * static_cast<std::size_t>(n.slot);
    IA.p.f = IA.p.f - Space::from(G::linear(F, 0));
    IA.p.t = IA.p.t - Space::from_axial(to<W>(G::matrix(b, moving::A) * G::axial(F, 3)));
  }

  template <class Rows>
  LOCKSTEP_INLINE void inward(Rows& rows) const {
    const L g = G::linear(z.gravity, 0);
    lockstep::inward(
        *this, rows,
        z.waiting, [&](std::size_t k, Inertia & IA) __attribute__((always_inline)) { add_slot(k, g, IA); });
  }
  /// d/dt of translations and angles are the velocities; e' = (1/2) e w (1.8).
  template <class Rows = NoRows>
  LOCKSTEP_INLINE void accelerate(const Array& rate, Rows&& rows = {}) const {
    inward(rows);
    lockstep::outward(*this, rows, rate + plan.n_q);
    for (const NumberNode& n : plan.nodes) {
      const Array q = z.y + n.q, v = z.y + (plan.n_q + n.v), qd = rate + n.q;
      const auto single = static_cast<std::size_t>(n.n_slides + (n.turn == TreeTurn::hinge ? 1 : 0));
      for (std::size_t i = 0; i < single; ++i) qd[i] = v[i];
      if (n.turn != TreeTurn::ball) continue;
      const auto e = load4(q, single);
      const auto w = 0.5 * load3(v, single);
      qd[single] = -dot(e.v, w);
      store3(qd, single + 1, e.w * w + cross(e.v, w));
    }
  }
};

}  // namespace lockstep::numbers
