// The recursion of a tree in space (dynamics/tree/recursion_in.h) on packs: its nodes, and how they move. World axes;
// forces and accelerations of a slot about its mass centre. Private to the room.
#pragma once

#include "framework/dynamics/tree/recursion_in.h"
#include "framework/foundation/math/sin_cos.h"
#include "framework/tools/batch/lane_joint.h"

namespace lockstep::lanes::LOCKSTEP_SET {

LOCKSTEP_LANE void store4(double* p, std::size_t at, const Q4& q) { store(p, at, q.w), store3(p, at + 1, q.v); }

LOCKSTEP_LANE Symmetric load_symmetric(const double* p, std::size_t at) {
  return {load(p, at), load(p, at + 1), load(p, at + 2), load(p, at + 3), load(p, at + 4), load(p, at + 5)};
}

// ------------------------------------------------------------------------------------------------ first pass, outward

/// Writes the motion of a node and the axes of its coordinates. kHinge: it is_hinge().
template <bool kHinge>
LOCKSTEP_LANE void carry(const LaneNode& n, const TreePlan& plan, const TreeNumbers& z, std::size_t k) {
  const double* p = pack(z.moving, moving::size * static_cast<std::size_t>(n.parent + 1));
  double* b = pack(z.moving, moving::size * (k + 1));
  Travel& travel = travel_of(z, k);
  const M3 A_p = load9(p, moving::A);
  const V3 w_p = load3(p, moving::w);
  Q4 e;
  M3 A;
  V3 w, v;
  if (!kHinge && n.moving) {
    MovingFrame<V3, M3, Q4, false> f{load4(p, moving::e), A_p, w_p};
    const JointAxes<V3> at = take_along(n, plan, z, k, z.y, f);
    e = near_unit(f.e), A = rotation(e), w = f.w, v = f.v;
    travel = {f.x, {f.a, f.al}};
    bodies::put_axes(n.n_slides, n.n_v(), at, V3(f.x - at.X), coordinates(z, n.v));
  } else {
    const LaneJoint<kHinge> joint(n, z);
    const JointMotion<LaneJoint<kHinge>, LaneArray> m{joint, reads(z.y, n.q), reads(z.y, plan.n_q + n.v)};
    e = m.orientation(load(z.cosine, k), load(z.sine, k), load4(p, moving::e)), A = rotation(e);
    const Carried<V3> c = m.carried(A_p, A, w_p);
    w = c.w, v = m.velocity(c, w_p);
    travel.r = c.d1 + c.d2;
    m.biases(c, A_p, A, w_p, travel.c.a, travel.c.al);
    bodies::put_axes(joint.n_slides(), kHinge ? 1 : n.n_v(), c, c.d2, coordinates(z, n.v));
  }
  store4(b, moving::e, e);
  store3(b, moving::A, A.r0), store3(b, moving::A + 3, A.r1), store3(b, moving::A + 6, A.r2);
  store3(b, moving::w, w);
  if (!z.with_positions) return;
  store3(b, moving::x, load3(p, moving::x) + travel.r), store3(b, moving::v, load3(p, moving::v) + v);
}

LOCKSTEP_LANE void outward(const TreePlan& plan, const TreeNumbers& z) {
  for (std::size_t k = 0; k < plan.nodes.size(); ++k)
    plan.nodes[k].is_hinge() ? carry<true>(plan.nodes[k], plan, z, k) : carry<false>(plan.nodes[k], plan, z, k);
}

/// Of all eight lanes.
LOCKSTEP_LANE void half_turns(const TreePlan& plan, const TreeNumbers& z) {
  for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
    const LaneNode& n = plan.nodes[k];
    if (n.turn != TreeTurn::hinge) continue;
    const double* q = pack(z.y, n.q + static_cast<std::size_t>(n.n_slides));
    for (std::size_t l = 0; l < kL; ++l) z.half[kL * k + l] = 0.5 * q[l];
  }
  sin_cos(z.half, kL * plan.nodes.size(), z.sine, z.cosine);
}

// --------------------------------------------------------------------------------------- second and third pass

LOCKSTEP_LANE Space::Twist found_at(const TreeNumbers& z, std::size_t k) {
  const double* b = pack(z.moving, moving::size * (k + 1));
  return {load3(b, moving::a), load3(b, moving::al)};
}

/// The nodes, for the recursion (dynamics/tree/recursion_in.h).
struct LaneSlots {
  using Space = LOCKSTEP_SET::Space;
  const TreePlan& plan;
  const TreeNumbers& z;

  LOCKSTEP_LANE std::size_t size() const { return plan.nodes.size(); }
  LOCKSTEP_LANE int parent(std::size_t k) const { return plan.nodes[k].parent; }
  LOCKSTEP_LANE int first_v(std::size_t k) const { return static_cast<int>(plan.nodes[k].v); }
  LOCKSTEP_LANE const InwardPlace& place(std::size_t k) const { return plan.nodes[k]; }
  template <class F>
  LOCKSTEP_LANE void with_joint(std::size_t k, F&& f) const {
    const LaneNode& n = plan.nodes[k];
    const Travel& t = travel_of(z, k);
    f(bodies::JointPasses<Space>{coordinates(z, n.v), n.n_v(), t.r, t.c});
  }
  LOCKSTEP_LANE Space::Twist found(std::size_t k) const { return found_at(z, k); }
  LOCKSTEP_LANE const Space::Twist& put(std::size_t k, const Space::Twist& found) const {
    double* b = pack(z.moving, moving::size * (k + 1));
    store3(b, moving::a, found.a), store3(b, moving::al, found.al);
    return found;
  }
  /// |a|^2, |al|^2
  struct Largest {
    V a2{}, al2{};
    LOCKSTEP_LANE void add(const V& own_a2, const V& own_al2) {
      a2 = largest_or_nan(a2, own_a2), al2 = largest_or_nan(al2, own_al2);
    }
    LOCKSTEP_LANE void put(double* out) const { store(out, 0, a2), store(out, 1, al2); }
  };

  /// M = m 1, H = 0, I = A J A', p = (-m g - F, w x I w - T)
  LOCKSTEP_LANE void add_slot(std::size_t k, const V3& g, Space::Inertia& IA) const {
    const LaneNode& n = plan.nodes[k];
    const double *b = pack(z.moving, moving::size * (k + 1)), *j = pack(z.joint, n.joint);
    const V m = load(j, joint::m);
    const V3 w = load3(b, moving::w);
    const M3 A = load9(b, moving::A);
    const Symmetric I = Symmetric::turned(A, load_symmetric(j, joint::J));
    IA.M.xx += m, IA.M.yy += m, IA.M.zz += m;
    IA.I = IA.I + I;
    IA.p.f = IA.p.f - m * g, IA.p.t = IA.p.t + cross(w, I * w);
    if (!z.wrench) return;
    const double* F = pack(z.wrench, 6 * static_cast<std::size_t>(n.slot));
    IA.p.f = IA.p.f - load3(F, 0), IA.p.t = IA.p.t - A * load3(F, 3);
  }
};

template <class Rows>
LOCKSTEP_LANE void inward(const TreePlan& plan, const TreeNumbers& z, Rows& rows) {
  const LaneSlots slots{plan, z};
  const V3 g = load3(z.gravity, 0);
  auto* waiting = reinterpret_cast<Space::Inertia*>(z.waiting);
  lockstep::inward(
      slots, rows,
      waiting, [&](std::size_t k, Space::Inertia & IA) __attribute__((always_inline)) { slots.add_slot(k, g, IA); });
}
template <class Rows>
LOCKSTEP_LANE void solve(const TreePlan& plan, const TreeNumbers& z, double* rate, Rows& rows) {
  const LaneSlots slots{plan, z};
  lockstep::outward(slots, rows, LaneArray{pack(rate, plan.n_q)}).put(z.largest);
}

/// d/dt of translations and angles are the velocities; e' = (1/2) e w (1.8).
LOCKSTEP_LANE void kinematic_rates(const TreePlan& plan, const TreeNumbers& z, double* rate) {
  for (const LaneNode& n : plan.nodes) {
    const double *q = pack(z.y, n.q), *v = pack(z.y, plan.n_q + n.v);
    double* qd = pack(rate, n.q);
    const auto single = static_cast<std::size_t>(n.n_slides + (n.turn == TreeTurn::hinge ? 1 : 0));
    for (std::size_t i = 0; i < single; ++i) store(qd, i, load(v, i));
    if (n.turn != TreeTurn::ball) continue;
    const Q4 e = load4(q, single);
    const V3 w = 0.5 * load3(v, single);
    store(qd, single, -dot(e.v, w));
    store3(qd, single + 1, e.w * w + cross(e.v, w));
  }
}

LOCKSTEP_LANE void accelerate_tree(const TreePlan& plan, const TreeNumbers& z, double* rate) {
  NoRows none;
  inward(plan, z, none);
  solve(plan, z, rate, none);
  kinematic_rates(plan, z, rate);
}

// ------------------------------------------------------------------------------------------- errors on the bodies

/// Squares in each lane: position, orientation, velocity, angular velocity of the slot that has most. A NaN stays.
struct LaneSizes {
  V x{}, r{}, v{}, w{};
  LOCKSTEP_LANE void take(const V& dx, const V& dr, const V& dv, const V& dw) {
    x = largest_or_nan(x, dx), r = largest_or_nan(r, dr), v = largest_or_nan(v, dv), w = largest_or_nan(w, dw);
  }
  LOCKSTEP_LANE void put(double* out) const { store(out, 0, x), store(out, 1, r), store(out, 2, v), store(out, 3, w); }
};

/// Writes the motions as outward() has left them, and what changed since `before` in a step of h; not less than the
/// velocities there give.
LOCKSTEP_LANE void change(const TreePlan& plan, const TreeNumbers& z, const double* before, const double* h,
                          double* now, double* out) {
  LaneSizes sizes;
  const V h2 = load(h, 0) * load(h, 0);
  for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
    const double *b = pack(z.moving, moving::size * (k + 1)), *was = pack(before, end::size * k);
    double* is = pack(now, end::size * k);
    const V3 x = load3(b, moving::x), v = load3(b, moving::v);
    const V3 w = transpose_times(load9(b, moving::A), load3(b, moving::w));
    const Q4 e = load4(b, moving::e), e0 = load4(was, end::e);
    const V3 dx = x - load3(was, end::x), dv = v - load3(was, end::v), dw = w - load3(was, end::w);
    const V3 dr = e0.w * e.v - e.w * e0.v - cross(e0.v, e.v);
    sizes.take(dot(dx, dx), 4.0 * dot(dr, dr), dot(dv, dv), dot(dw, dw));
    const V3 v0 = load3(was, end::v), w0 = load3(was, end::w);
    sizes.take(h2 * dot(v0, v0), h2 * dot(w0, w0), V{}, V{});
    store3(is, end::x, x), store4(is, end::e, e), store3(is, end::v, v), store3(is, end::w, w);
  }
  sizes.put(out);
}

/// How an error dy of q and v moves the slots, at the motions as outward() has left them.
LOCKSTEP_LANE void vary(const TreePlan& plan, const TreeNumbers& z, const double* dy, double* out) {
  LaneSizes sizes;
  for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
    const LaneNode& n = plan.nodes[k];
    const auto parent = static_cast<std::size_t>(n.parent + 1);
    const double *p = pack(z.moving, moving::size * parent), *b = pack(z.moving, moving::size * (k + 1));
    const double* of_parent = pack(z.varied, varied::size * parent);
    const Variation<V3> dp{load3(of_parent, varied::x), load3(of_parent, varied::phi), load3(of_parent, varied::v),
                           load3(of_parent, varied::w)};
    const M3 A_p = load9(p, moving::A);
    const V3 w_p = load3(p, moving::w), w = load3(b, moving::w);
    Variation<V3> d;
    if (n.moving) {
      MovingFrame<V3, M3, Q4, true> f{load4(p, moving::e), A_p, w_p};
      f.dx = dp.x, f.dphi = dp.phi, f.dv = dp.v, f.dw = dp.w;
      take_along(n, plan, z, k, dy, f);
      d = {f.dx, f.dphi, f.dv, f.dw};
    } else {
      const LaneJoint<false> joint(n, z);
      const JointMotion<LaneJoint<false>, LaneArray> m{joint, reads(z.y, n.q), reads(z.y, plan.n_q + n.v)};
      d = m.vary(A_p, load9(b, moving::A), w_p, reads(dy, n.q), reads(dy, plan.n_q + n.v), dp);
    }
    double* own = pack(z.varied, varied::size * (k + 1));
    store3(own, varied::x, d.x), store3(own, varied::phi, d.phi);
    store3(own, varied::v, d.v), store3(own, varied::w, d.w);
    const V3 in_slot = d.w - cross(d.phi, w);
    sizes.take(dot(d.x, d.x), dot(d.phi, d.phi), dot(d.v, d.v), dot(in_slot, in_slot));
  }
  sizes.put(out);
}

/// The arrays of eight lanes side by side, beginning at this lane,
LOCKSTEP_LANE TreeNumbers from(const TreeNumbers& z, int lane) {
  TreeNumbers n = z;
  if (n.wrench) n.wrench += lane;
  for (const double** p : {&n.y, &n.gravity, &n.joint, &n.more, &n.law}) *p += lane;
  for (double** p : {&n.half, &n.cosine, &n.sine, &n.moving, &n.largest, &n.varied}) *p += lane;
  return n;
}
/// and with those that only the recursion reads, one after another for each round.
LOCKSTEP_LANE TreeNumbers from(const TreePlan& plan, const TreeNumbers& z, int lane) {
  TreeNumbers n = from(z, lane);
  const auto l = static_cast<std::size_t>(lane);
  n.travel += l * travel::size * plan.nodes.size(), n.dof += l * dof::size * plan.n_v;
  n.waiting += l * articulated::size * plan.n_waiting;
  return n;
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
