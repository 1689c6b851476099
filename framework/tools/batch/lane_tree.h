// The recursion of a tree in space, in lanes: articulated inertias (Featherstone 2008, chapter 7) on packs, as
// dynamics/tree/articulated.cpp has them for one mechanism. World axes; wrenches and accelerations of a slot about its
// mass centre. Private to the room.
//
// A joint of several coordinates is eliminated one coordinate after another, as joints of one each in a row.
#pragma once

#include "framework/foundation/math/sin_cos.h"
#include "framework/tools/batch/lane_math.h"
#include "framework/tools/batch/lane_moving.h"
#include "framework/tools/batch/tree_plan.h"

namespace lockstep::lanes::LOCKSTEP_SET {

template <class T>
LOCKSTEP_LANE T* pack(T* p, std::size_t at) {
  return p + kLanes * at;
}
LOCKSTEP_LANE void store4(double* p, std::size_t at, const Q4& q) { store(p, at, q.w), store3(p, at + 1, q.v); }
LOCKSTEP_LANE V3 zero3() { return V3{V{}, V{}, V{}}; }

/// xx xy xz yy yz zz
struct Symmetric {
  V xx, xy, xz, yy, yz, zz;
};
LOCKSTEP_LANE Symmetric load_symmetric(const double* p, std::size_t at) {
  return {load(p, at), load(p, at + 1), load(p, at + 2), load(p, at + 3), load(p, at + 4), load(p, at + 5)};
}
LOCKSTEP_LANE void store_symmetric(double* p, std::size_t at, const Symmetric& S) {
  store(p, at, S.xx), store(p, at + 1, S.xy), store(p, at + 2, S.xz);
  store(p, at + 3, S.yy), store(p, at + 4, S.yz), store(p, at + 5, S.zz);
}
LOCKSTEP_LANE V3 operator*(const Symmetric& S, const V3& a) {
  return {S.xx * a.x + S.xy * a.y + S.xz * a.z, S.xy * a.x + S.yy * a.y + S.yz * a.z,
          S.xz * a.x + S.yz * a.y + S.zz * a.z};
}
LOCKSTEP_LANE Symmetric sum(const Symmetric& a, const Symmetric& b) {
  return {a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
}
/// S <- S - x y', which is symmetric.
LOCKSTEP_LANE void subtract_dyad(Symmetric& S, const V3& x, const V3& y) {
  S.xx -= x.x * y.x, S.xy -= x.x * y.y, S.xz -= x.x * y.z, S.yy -= x.y * y.y, S.yz -= x.y * y.z, S.zz -= x.z * y.z;
}
/// A J A'
LOCKSTEP_LANE Symmetric turned(const M3& A, const Symmetric& J) {
  const V3 a = J * A.r0, b = J * A.r1, c = J * A.r2;
  return {dot(A.r0, a), dot(A.r0, b), dot(A.r0, c), dot(A.r1, b), dot(A.r1, c), dot(A.r2, c)};
}

/// force = M a + H al + f, moment = H' a + I al + t; H by its columns
struct LaneInertia {
  Symmetric M{}, I{};
  V3 h0, h1, h2, f, t;

  LOCKSTEP_LANE V3 force(const V3& a, const V3& al) const { return M * a + al.x * h0 + al.y * h1 + al.z * h2; }
  LOCKSTEP_LANE V3 moment(const V3& a, const V3& al) const { return V3{dot(h0, a), dot(h1, a), dot(h2, a)} + I * al; }
  LOCKSTEP_LANE void clear() {
    M = I = Symmetric{};
    h0 = h1 = h2 = f = t = zero3();
  }
  LOCKSTEP_LANE void add(const double* p) {
    M = sum(M, load_symmetric(p, articulated::M)), I = sum(I, load_symmetric(p, articulated::I));
    h0 = h0 + load3(p, articulated::H), h1 = h1 + load3(p, articulated::H + 3), h2 = h2 + load3(p, articulated::H + 6);
    f = f + load3(p, articulated::f), t = t + load3(p, articulated::t);
  }
  LOCKSTEP_LANE void put(double* p) const {
    store_symmetric(p, articulated::M, M), store_symmetric(p, articulated::I, I);
    store3(p, articulated::H, h0), store3(p, articulated::H + 3, h1), store3(p, articulated::H + 6, h2);
    store3(p, articulated::f, f), store3(p, articulated::t, t);
  }
  /// IA <- IA - U D^-1 U', p <- p + U D^-1 u
  LOCKSTEP_LANE void reduce(const V3& Uf, const V3& Ut, const V& u, const V& D_1) {
    const V3 x = D_1 * Uf, y = D_1 * Ut;
    subtract_dyad(M, x, Uf), subtract_dyad(I, y, Ut);
    h0 = h0 - Ut.x * x, h1 = h1 - Ut.y * x, h2 = h2 - Ut.z * x;
    f = f + u * x, t = t + u * y;
  }
  /// p <- p + IA c, then all about the parent's mass centre: X' IA X and X' p with X = [1 -r~; 0 1]
  LOCKSTEP_LANE void shift(const V3& r, const V3& ca, const V3& cal) {
    f = f + force(ca, cal), t = t + moment(ca, cal);
    const V3 k0 = cross(r, h0), k1 = cross(r, h1), k2 = cross(r, h2);
    // H <- H - M r~
    const V3 m0{M.xx, M.xy, M.xz}, m1{M.xy, M.yy, M.yz}, m2{M.xz, M.yz, M.zz};
    h0 = h0 - (r.z * m1 - r.y * m2), h1 = h1 - (r.x * m2 - r.z * m0), h2 = h2 - (r.y * m0 - r.x * m1);
    // I <- I - H' r~ + r~ H of before and after
    const V3 n0 = cross(r, h0), n1 = cross(r, h1), n2 = cross(r, h2);
    I.xx += k0.x + n0.x, I.xy += k0.y + n1.x, I.xz += k0.z + n2.x;
    I.yy += k1.y + n1.y, I.yz += k1.z + n2.y, I.zz += k2.z + n2.z;
    t = t + cross(r, f);
  }
};

// ------------------------------------------------------------------------------------------------ first pass, outward

/// The turn of far against near, laws included: e = e_p near r far' or e_p near r' far'.
LOCKSTEP_LANE Q4 turn_of(const LaneNode& n, const TreeNumbers& z, std::size_t k, const double* q) {
  const double *c = pack(z.more, n.more), *law = pack(z.law, n.law);
  Q4 r{V{} + 1.0, zero3()};
  if (n.turn == TreeTurn::hinge) {
    r = Q4{load(z.cosine, k), load(z.sine, k) * load3(c, more::hinge)};
  } else if (n.turn == TreeTurn::ball) {
    r = load4(q, static_cast<std::size_t>(n.n_slides));
    const V unit = 1.0 / square_root(r.w * r.w + dot(r.v, r.v));
    r = unit * r;
  }
  return n.has_law ? load4(law, imposed::q) * r : r;
}

LOCKSTEP_LANE Q4 orientation(const LaneNode& n, const TreeNumbers& z, std::size_t k, const double* q,
                             const Q4& parent) {
  const double* j = pack(z.joint, n.joint);
  Q4 e = parent;
  if (n.turn == TreeTurn::ball || n.has_law) {
    const double* c = pack(z.more, n.more);
    const Q4 r = turn_of(n, z, k, q), back = conjugate(r);
    e = parent * (load4(c, more::near_q) * (n.reversed ? back : r) * conjugate(load4(c, more::far_q)));
  } else if (n.turn == TreeTurn::hinge) {
    e = parent * (load(z.cosine, k) * load4(j, joint::K0) + load(z.sine, k) * load4(j, joint::K1));
  } else {
    e = parent * load4(j, joint::K0);
  }
  // Products of unit quaternions are of unit length to round-off; along a chain that adds up: one step of Newton's.
  const V unit = 1.5 - 0.5 * (e.w * e.w + dot(e.v, e.v));
  return unit * e;
}

LOCKSTEP_LANE void carry(const LaneNode& n, const TreePlan& plan, const TreeNumbers& z, std::size_t k) {
  const double *q = pack(z.y, n.q), *v = pack(z.y, plan.n_q + n.v), *j = pack(z.joint, n.joint);
  const double* p = pack(z.moving, moving::size * static_cast<std::size_t>(n.parent + 1));
  double *b = pack(z.moving, moving::size * (k + 1)), *d = pack(z.dof, dof::size * n.v);
  const auto slides = static_cast<std::size_t>(n.n_slides);

  const Q4 e = orientation(n, z, k, q, load4(p, moving::e));
  const M3 A = rotation(e), A_p = load9(p, moving::A);
  const V3 w_p = load3(p, moving::w);
  V3 d1 = A_p * load3(j, joint::near), d2 = -(A * load3(j, joint::far)), slide = zero3(), turn = zero3();

  if (n.turn == TreeTurn::hinge) {
    const V3 axis = A_p * (n.has_law ? load3(pack(z.law, n.law), imposed::axis) : load3(j, joint::axis));
    turn = load(v, slides) * axis;
    store3(d, dof::size * slides + dof::n, axis);
  } else if (n.turn == TreeTurn::ball) {
    const M3 B = (n.reversed ? A_p : A) * load9(pack(z.more, n.more), more::ball);
    const V3 axes[3] = {{B.r0.x, B.r1.x, B.r2.x}, {B.r0.y, B.r1.y, B.r2.y}, {B.r0.z, B.r1.z, B.r2.z}};
    for (std::size_t i = 0; i < 3; ++i) {
      turn = turn + load(v, slides + i) * axes[i];
      store3(d, dof::size * (slides + i) + dof::n, axes[i]);
    }
  }
  V3 w = w_p + turn, cal = cross(w_p, turn), pdd = zero3();
  if (n.n_slides > 0 || n.has_law) {
    const M3& S = n.reversed ? A : A_p;
    V3 rho = zero3();
    for (std::size_t i = 0; i < slides; ++i) {
      const V3 along = S * load3(pack(z.more, n.more), more::slide + 3 * i);
      rho = rho + load(q, i) * along, slide = slide + load(v, i) * along;
      store3(d, dof::size * i + dof::l, along), store3(d, dof::size * i + dof::n, zero3());
    }
    if (n.has_law) {
      const double* now = pack(z.law, n.law);
      const V3 law = S * load3(now, imposed::w);
      rho = rho + S * load3(now, imposed::p), slide = slide + S * load3(now, imposed::pd);
      pdd = S * load3(now, imposed::pdd);
      w = w + law;
      cal = cal + S * load3(now, imposed::a) + cross(w_p, law) + (n.reversed ? cross(turn, law) : cross(law, turn));
    }
    if (n.reversed)
      d2 = d2 + rho;
    else
      d1 = d1 + rho;
  }
  V3 ca = cross(w_p, cross(w_p, d1)) + cross(w, cross(w, d2)) + cross(cal, d2);
  if (n.n_slides > 0 || n.has_law) ca = ca + 2.0 * cross(n.reversed ? w : w_p, slide) + pdd;
  for (std::size_t i = slides; i < static_cast<std::size_t>(n.n_v()); ++i)
    store3(d, dof::size * i + dof::l, cross(load3(d, dof::size * i + dof::n), d2));

  store4(b, moving::e, e);
  store3(b, moving::A, A.r0), store3(b, moving::A + 3, A.r1), store3(b, moving::A + 6, A.r2);
  store3(b, moving::w, w), store3(b, moving::r, d1 + d2), store3(b, moving::ca, ca), store3(b, moving::cal, cal);
  if (!z.with_positions) return;
  store3(b, moving::x, load3(p, moving::x) + (d1 + d2));
  store3(b, moving::v, load3(p, moving::v) + cross(w_p, d1) + slide + cross(w, d2));
}

LOCKSTEP_LANE void outward(const TreePlan& plan, const TreeNumbers& z) {
  for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
    const LaneNode& n = plan.nodes[k];
    n.moving ? carry_moving(n, plan, z, k) : carry(n, plan, z, k);
  }
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

/// U = IA S, D = S' U, u = -S' p of each coordinate, which then is no more in IA.
LOCKSTEP_LANE void eliminate(const LaneNode& n, const TreeNumbers& z, LaneInertia& IA) {
  for (int i = 0; i < n.n_v(); ++i) {
    double* d = pack(z.dof, dof::size * (n.v + static_cast<std::size_t>(i)));
    const V3 l = load3(d, dof::l), a = load3(d, dof::n);
    const V3 Uf = IA.force(l, a), Ut = IA.moment(l, a);
    const V u = -dot(l, IA.f) - dot(a, IA.t), D_1 = 1.0 / (dot(l, Uf) + dot(a, Ut));
    store3(d, dof::Uf, Uf), store3(d, dof::Ut, Ut), store(d, dof::u, u), store(d, dof::D_1, D_1);
    if (n.to != -1 || i + 1 < n.n_v()) IA.reduce(Uf, Ut, u, D_1);
  }
}

/// In the place of rows that close loops, where there are none (lane_closures.h).
struct NoRows {
  static constexpr bool kAny = false;
  LOCKSTEP_LANE void close(std::size_t, LaneInertia&) const {}
  LOCKSTEP_LANE void pass_on(const LaneNode&, const TreeNumbers&, std::size_t) const {}
  LOCKSTEP_LANE void find(std::size_t, const V3&, const V3&) const {}
};

template <class Rows>
LOCKSTEP_LANE void inward(const TreePlan& plan, const TreeNumbers& z, const Rows& rows) {
  const V3 g = load3(z.gravity, 0);
  LaneInertia IA;
  for (std::size_t k = plan.nodes.size(); k-- > 0;) {
    const LaneNode& n = plan.nodes[k];
    const double *b = pack(z.moving, moving::size * (k + 1)), *j = pack(z.joint, n.joint);
    if (!n.from_next) IA.clear();
    if (n.own >= 0) IA.add(pack(z.waiting, articulated::size * static_cast<std::size_t>(n.own)));
    // M = m 1, H = 0, I = A J A', p = (-m g - F, w x I w - T)
    const V m = load(j, joint::m);
    const V3 w = load3(b, moving::w);
    const M3 A = load9(b, moving::A);
    const Symmetric I = turned(A, load_symmetric(j, joint::J));
    IA.M.xx += m, IA.M.yy += m, IA.M.zz += m;
    IA.I = sum(IA.I, I);
    IA.f = IA.f - m * g, IA.t = IA.t + cross(w, I * w);
    if (z.wrench) {
      const double* F = pack(z.wrench, 6 * static_cast<std::size_t>(n.slot));
      IA.f = IA.f - load3(F, 0), IA.t = IA.t - A * load3(F, 3);
    }
    rows.close(k, IA);
    eliminate(n, z, IA);
    rows.pass_on(n, z, k);
    if (n.to == -1) continue;
    IA.shift(load3(b, moving::r), load3(b, moving::ca), load3(b, moving::cal));
    if (n.to == LaneNode::kNext) continue;
    double* there = pack(z.waiting, articulated::size * static_cast<std::size_t>(n.to));
    if (!n.first) IA.add(there);
    IA.put(there);
  }
}

/// vd = D^-1 (u - U' a') - V' lambda, a' = (a_p + al_p x r + ca, al_p + cal): who was eliminated last comes first.
template <class Rows>
LOCKSTEP_LANE void solve(const TreePlan& plan, const TreeNumbers& z, double* rate, const Rows& rows) {
  V most{}, most_turned{};
  for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
    const LaneNode& n = plan.nodes[k];
    const double* p = pack(z.moving, moving::size * static_cast<std::size_t>(n.parent + 1));
    double *b = pack(z.moving, moving::size * (k + 1)), *vd = pack(rate, plan.n_q + n.v);
    V3 a = load3(b, moving::ca), al = load3(b, moving::cal);
    if (n.parent >= 0) {
      const V3 al_p = load3(p, moving::al);
      a = a + load3(p, moving::a) + cross(al_p, load3(b, moving::r)), al = al + al_p;
    }
    for (int i = n.n_v(); i-- > 0;) {
      const double* d = pack(z.dof, dof::size * (n.v + static_cast<std::size_t>(i)));
      V x = load(d, dof::D_1) * (load(d, dof::u) - dot(load3(d, dof::Uf), a) - dot(load3(d, dof::Ut), al));
      if constexpr (Rows::kAny) x -= rows.less(k, n.n_v(), i);
      store(vd, static_cast<std::size_t>(i), x);
      a = a + x * load3(d, dof::l), al = al + x * load3(d, dof::n);
    }
    store3(b, moving::a, a), store3(b, moving::al, al);
    rows.find(k, a, al);
    const V a2 = dot(a, a), al2 = dot(al, al);
    most = largest_or_nan(most, a2), most_turned = largest_or_nan(most_turned, al2);
  }
  store(z.largest, 0, most), store(z.largest, 1, most_turned);
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
  inward(plan, z, NoRows{});
  solve(plan, z, rate, NoRows{});
  kinematic_rates(plan, z, rate);
}

// ------------------------------------------------------------------------------------------- errors on the bodies

/// Squares in each lane: position, orientation, velocity, angular velocity of the slot that has most. A NaN stays.
struct LaneSizes {
  V x{}, r{}, v{}, w{};
  LOCKSTEP_LANE void take(const V& dx, const V& dr, const V& dv, const V& dw) {
    x = largest_or_nan(x, dx), r = largest_or_nan(r, dr), v = largest_or_nan(v, dv), w = largest_or_nan(w, dw);
  }
  /// How a node varies, and its motion.
  LOCKSTEP_LANE void take_varied(const double* d, const double* b) {
    const V3 dx = load3(d, varied::x), phi = load3(d, varied::phi), dv = load3(d, varied::v);
    const V3 in_slot = load3(d, varied::w) - cross(phi, load3(b, moving::w));
    take(dot(dx, dx), dot(phi, phi), dot(dv, dv), dot(in_slot, in_slot));
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

/// How an error dy of q and v moves the slots, at the motions as outward() has left them: vary() of
/// dynamics/tree/tree_motion.h.
LOCKSTEP_LANE void vary(const TreePlan& plan, const TreeNumbers& z, const double* dy, double* out) {
  LaneSizes sizes;
  for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
    const LaneNode& n = plan.nodes[k];
    if (n.moving) {
      vary_moving(n, plan, z, k, dy);
      sizes.take_varied(pack(z.varied, varied::size * (k + 1)), pack(z.moving, moving::size * (k + 1)));
      continue;
    }
    const auto parent = static_cast<std::size_t>(n.parent + 1), slides = static_cast<std::size_t>(n.n_slides);
    const double *q = pack(z.y, n.q), *v = pack(z.y, plan.n_q + n.v), *j = pack(z.joint, n.joint);
    const double *dq = pack(dy, n.q), *dv = pack(dy, plan.n_q + n.v), *d = pack(z.dof, dof::size * n.v);
    const double *p = pack(z.moving, moving::size * parent), *b = pack(z.moving, moving::size * (k + 1));
    const double* dp = pack(z.varied, varied::size * parent);
    const M3 A = load9(b, moving::A), A_p = load9(p, moving::A);
    const V3 w_p = load3(p, moving::w), w = load3(b, moving::w);
    const V3 phi_p = load3(dp, varied::phi), dw_p = load3(dp, varied::w);

    V3 turned = zero3(), turn = zero3(), faster = zero3();  // by dq, at v, by dv
    if (n.turn == TreeTurn::hinge) {
      const V3 axis = load3(d, dof::size * slides + dof::n);
      turned = load(dq, slides) * axis, turn = load(v, slides) * axis, faster = load(dv, slides) * axis;
    } else if (n.turn == TreeTurn::ball) {  // twice the vector part of r' dr
      const Q4 r = load4(q, slides), dr = load4(dq, slides);
      const V unit = 2.0 / (r.w * r.w + dot(r.v, r.v));
      const V3 by = unit * (r.w * dr.v - dr.w * r.v - cross(r.v, dr.v));
      const V parts[3] = {by.x, by.y, by.z};
      for (std::size_t i = 0; i < 3; ++i) {
        const V3 axis = load3(d, dof::size * (slides + i) + dof::n);
        turned = turned + parts[i] * axis;
        turn = turn + load(v, slides + i) * axis, faster = faster + load(dv, slides + i) * axis;
      }
    }
    const V3 phi = phi_p + turned;
    V3 dw = dw_p + faster + cross(n.turn == TreeTurn::ball && !n.reversed ? phi : phi_p, turn);
    V3 d1 = A_p * load3(j, joint::near), d2 = -(A * load3(j, joint::far));
    V3 slide = zero3(), moved = zero3(), slid = zero3();  // velocity of the slides, of them by dq, by dv
    if (n.n_slides > 0 || n.has_law) {
      V3 rho = zero3();
      for (std::size_t i = 0; i < slides; ++i) {
        const V3 along = load3(d, dof::size * i + dof::l);
        rho = rho + load(q, i) * along, slide = slide + load(v, i) * along;
        moved = moved + load(dq, i) * along, slid = slid + load(dv, i) * along;
      }
      if (n.has_law) {
        const M3& S = n.reversed ? A : A_p;
        const double* now = pack(z.law, n.law);
        rho = rho + S * load3(now, imposed::p), slide = slide + S * load3(now, imposed::pd);
        dw = dw + cross(n.reversed ? phi : phi_p, S * load3(now, imposed::w));
      }
      if (n.reversed)
        d2 = d2 + rho;
      else
        d1 = d1 + rho;
    }
    V3 by1 = cross(phi_p, d1), by2 = cross(phi, d2);
    if (n.reversed)
      by2 = by2 + moved;
    else
      by1 = by1 + moved;
    const V3 x = load3(dp, varied::x) + by1 + by2;
    const V3 faster_x = load3(dp, varied::v) + cross(dw_p, d1) + cross(w_p, by1) +
                        cross(n.reversed ? phi : phi_p, slide) + slid + cross(dw, d2) + cross(w, by2);
    double* own = pack(z.varied, varied::size * (k + 1));
    store3(own, varied::x, x), store3(own, varied::phi, phi), store3(own, varied::v, faster_x);
    store3(own, varied::w, dw);
    const V3 in_slot = dw - cross(phi, w);
    sizes.take(dot(x, x), dot(phi, phi), dot(faster_x, faster_x), dot(in_slot, in_slot));
  }
  sizes.put(out);
}

/// The arrays, beginning at this lane.
LOCKSTEP_LANE TreeNumbers from(const TreeNumbers& z, int lane) {
  TreeNumbers n = z;
  if (n.wrench) n.wrench += lane;
  for (const double** p : {&n.y, &n.gravity, &n.joint, &n.more, &n.law}) *p += lane;
  for (double** p : {&n.half, &n.cosine, &n.sine, &n.moving, &n.dof, &n.waiting, &n.largest, &n.varied}) *p += lane;
  return n;
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
