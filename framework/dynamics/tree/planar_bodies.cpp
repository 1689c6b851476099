#include "framework/dynamics/tree/planar_bodies.h"

#include <algorithm>

#include "framework/foundation/math/sin_cos.h"

namespace lockstep {

void PlanarBodies::begin(const JointTree& tree, const System& system) {
  const std::vector<PlanarNode>& nodes = tree.planar()->nodes();
  const std::size_t n = nodes.size();
  nodes_.assign(n + 1, Node());
  slides_.resize(static_cast<std::size_t>(tree.n_v()));
  for (std::vector<double>* x : {&half_, &cosine_, &sine_}) x->assign((n + 7) / 8 * 8, 0.0);  // packs of up to 8
  std::vector<int> waits(n, -1);  // where what children of a node have passed on waits
  int n_waiting = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const PlanarNode& t = nodes[k];
    const Slot& slot = system.slot(t.slot);
    const Posture* posture = tree.planar()->posture(t);
    Node& b = nodes_[k + 1];
    b.normal = posture != nullptr ? posture->normal : Vec3(Vec3::Unit(tree.planar()->plane().n));
    b.m = slot.mass, b.J = b.normal.dot(slot.J * b.normal);
    if (t.parent < 0) continue;
    const auto parent = static_cast<std::size_t>(t.parent);
    if (parent + 1 == k) {
      b.to = kNext, nodes_[k].from_next = true;
    } else {
      if (waits[parent] < 0) waits[parent] = n_waiting++;
      b.to = nodes_[parent + 1].own = waits[parent];
    }
  }
  waiting_.assign(static_cast<std::size_t>(n_waiting), Inertia());
}

LOCKSTEP_FLAT_CLONES void PlanarBodies::outward(const JointTree& tree, const State& y, std::vector<Motion>& motions) {
  motions.resize(nodes_.size());
  const PlanarJoints& joints = *tree.planar();
  if (joints.plane().n == 0) return outward_along<0>(tree, joints, y, motions);
  if (joints.plane().n == 1) return outward_along<1>(tree, joints, y, motions);
  outward_along<2>(tree, joints, y, motions);
}

// a = a_p + al_p x r + ca,  ca = -w_p^2 r + 2 w x slide + ..., of the slot's point that is at the joint's point now
template <int k>
LOCKSTEP_INLINE void PlanarBodies::outward_along(const JointTree& tree, const PlanarJoints& joints, const State& y,
                                                 std::vector<Motion>& motions) {
  const std::vector<PlanarNode>& nodes = joints.nodes();
  for (std::size_t l = 0; l < nodes.size(); ++l) half_[l] = half_turn(nodes[l], y.q.data() + nodes[l].first_q);
  sin_cos(half_.data(), half_.size(), sine_.data(), cosine_.data());
  for (std::size_t l = 0; l < nodes.size(); ++l) {
    const PlanarNode& n = nodes[l];
    const Node& p = nodes_[static_cast<std::size_t>(n.parent + 1)];
    Node& b = nodes_[l + 1];
    PlanarImposed now;
    if (n.law >= 0) now = planar_laws_at(tree.nodes()[l], joints.law(n), y.t, y.s);
    const double *q = y.q.data() + n.first_q, *v = y.v.data() + n.first_v;
    const PlanarCarried add = carry(n, n.law < 0 ? nullptr : &now, cosine_[l], sine_[l], q, v, p.frame, b.frame);
    b.r = p.d + add.d1, b.d = add.d2;
    b.ca = -p.frame.w * p.frame.w * b.r;
    b.cal = 0;
    if (n.n_slides > 0 || n.law >= 0) {
      const PlanarFrame& carrier = n.reversed ? b.frame : p.frame;
      b.ca += 2.0 * carrier.w * across(add.slide) + add.pdd;
      b.cal = add.alpha;
      for (int i = 0; i < n.n_slides; ++i)
        slides_[static_cast<std::size_t>(n.first_v + i)].l =
            turned(carrier.c, carrier.s, n.slide[static_cast<std::size_t>(i)]);
    }
    write_motion<k>(b.frame, joints.posture(n), motions[static_cast<std::size_t>(n.slot + 1)]);
  }
}

LOCKSTEP_INLINE void PlanarBodies::Inertia::add(const Inertia& b) {
  Mii += b.Mii, Mij += b.Mij, Mjj += b.Mjj, I += b.I, tau += b.tau, h += b.h, p += b.p;
}

// U = IA S, D = S' U, u = -S' p; IA <- IA - U D^-1 U', p <- p + U D^-1 u; p <- p + IA c; then all about the parent's
// point. The turn has S = (0, 0, 1), which leaves neither h nor I: with s = n x r, about the parent's point,
//   M <- M - D^-1 h h',  h <- M s,  I <- s' M s,  p <- p + M c + D^-1 (u - h' c) h,  tau <- s' p
// written so that little waits for the division.
LOCKSTEP_INLINE void PlanarBodies::pass_hinge(Node& b, Inertia& IA) {
  const Flat s = across(b.r), h = IA.h;
  const Flat Ms{IA.Mii * s.i + IA.Mij * s.j, IA.Mij * s.i + IA.Mjj * s.j};
  const Flat p{IA.p.i + IA.Mii * b.ca.i + IA.Mij * b.ca.j, IA.p.j + IA.Mij * b.ca.i + IA.Mjj * b.ca.j};
  const double hs = dot(h, s), u = -IA.tau - dot(h, b.ca), D_1 = 1.0 / IA.I;
  b.g = D_1 * h, b.gs = D_1 * hs, b.u = D_1 * u;
  IA.Mii -= D_1 * (h.i * h.i), IA.Mij -= D_1 * (h.i * h.j), IA.Mjj -= D_1 * (h.j * h.j);
  IA.h = Ms - D_1 * (hs * h);
  IA.I = dot(s, Ms) - D_1 * (hs * hs);
  IA.p = p + D_1 * (u * h);
  IA.tau = dot(s, p) + D_1 * (u * hs);
}

// The same for any joint, one coordinate after another, the turn first.
LOCKSTEP_INLINE void PlanarBodies::eliminate(const PlanarNode& n, Node& b, Inertia& IA) {
  if (n.turns) {
    const double D_1 = 1.0 / IA.I;
    b.g = D_1 * IA.h, b.u = -D_1 * IA.tau;
    IA.Mii -= b.g.i * IA.h.i, IA.Mij -= b.g.i * IA.h.j, IA.Mjj -= b.g.j * IA.h.j;
    IA.p += b.u * IA.h;
    IA.h = {}, IA.I = 0, IA.tau = 0;
  }
  for (int i = 0; i < n.n_slides; ++i) {
    Slide& s = slides_[static_cast<std::size_t>(n.first_v + i)];
    s.U = {IA.Mii * s.l.i + IA.Mij * s.l.j, IA.Mij * s.l.i + IA.Mjj * s.l.j}, s.U_turn = dot(IA.h, s.l);
    s.D_1 = 1.0 / dot(s.l, s.U), s.u = -dot(s.l, IA.p);
    const Flat g = s.D_1 * s.U;
    const double g_turn = s.D_1 * s.U_turn;
    IA.Mii -= g.i * s.U.i, IA.Mij -= g.i * s.U.j, IA.Mjj -= g.j * s.U.j;
    IA.h += -s.U_turn * g, IA.I -= g_turn * s.U_turn;
    IA.p += s.u * g, IA.tau += s.u * g_turn;
  }
}

// p <- p + IA c, then all about the parent's point: a there is less by al x r.
LOCKSTEP_INLINE void PlanarBodies::shift(const Node& b, Inertia& IA) {
  const Flat s = across(b.r);
  IA.p += Flat{IA.Mii * b.ca.i + IA.Mij * b.ca.j, IA.Mij * b.ca.i + IA.Mjj * b.ca.j} + b.cal * IA.h;
  IA.tau += dot(IA.h, b.ca) + IA.I * b.cal;
  const Flat Ms{IA.Mii * s.i + IA.Mij * s.j, IA.Mij * s.i + IA.Mjj * s.j};
  IA.I += dot(s, Ms) + 2.0 * dot(s, IA.h);
  IA.h += Ms;
  IA.tau += dot(s, IA.p);
}

// Of a slot about its joint's point: M = m 1, h = m n x d, I = J + m d^2, p = -m w^2 d - f, tau = d x p - moment.
template <int k>
LOCKSTEP_INLINE void PlanarBodies::inward_along(const PlanarJoints& joints, const VecX& f) {
  constexpr int i = (k + 1) % 3, j = (k + 2) % 3;
  const std::vector<PlanarNode>& nodes = joints.nodes();
  for (Inertia& I : waiting_) I = {};
  Inertia IA;
  for (std::size_t l = nodes.size(); l-- > 0;) {
    const PlanarNode& n = nodes[l];
    Node& b = nodes_[l + 1];
    const double* on = f.data() + 6 * n.slot;
    const Flat e = across(b.d), h = b.m * e, p = (-b.m * b.frame.w * b.frame.w) * b.d - Flat{on[i], on[j]};
    if (!b.from_next) IA = {};
    if (b.own >= 0) IA.add(waiting_[static_cast<std::size_t>(b.own)]);
    const double moment = n.posture < 0 ? on[3 + k] : b.normal.dot(Vec3(on[3], on[4], on[5]));
    IA.Mii += b.m, IA.Mjj += b.m, IA.h += h, IA.p += p;
    IA.I += b.J + dot(e, h), IA.tau += dot(e, p) - moment;
    if (is_hinge(n)) {
      pass_hinge(b, IA);
    } else {
      eliminate(n, b, IA);
      shift(b, IA);
    }
    if (b.to >= 0) waiting_[static_cast<std::size_t>(b.to)].add(IA);
  }
}

// a' = a_p + al_p x r + ca, al' = al_p + cal; who was eliminated last comes first: qdd = D^-1 (u - U' a')
LOCKSTEP_INLINE PlanarBodies::Found PlanarBodies::solve(const PlanarNode& n, const Node& b, const Found& p,
                                                        VecX& vd) const {
  Found own{p.a + (p.al * across(b.r) + b.ca), p.al + b.cal};
  const double before = own.al;
  if (is_hinge(n)) {
    own.al = b.u - dot(b.g, p.a) - b.gs * p.al;
    vd[n.first_v] = n.sign * (own.al - before);
    return own;
  }
  for (int i = n.n_slides; i-- > 0;) {
    const Slide& s = slides_[static_cast<std::size_t>(n.first_v + i)];
    const double x = s.D_1 * (s.u - dot(s.U, own.a) - s.U_turn * own.al);
    vd[n.first_v + i] = x;
    own.a += x * s.l;
  }
  if (!n.turns) return own;
  own.al = b.u - dot(b.g, own.a);
  vd[n.first_v + n.n_slides] = n.sign * (own.al - before);
  return own;
}

LOCKSTEP_FLAT_CLONES void PlanarBodies::accelerate(const JointTree& tree, const VecX& f, VecX& vd) {
  vd.resize(tree.n_v());
  const PlanarJoints& joints = *tree.planar();
  switch (joints.plane().n) {
    case 0:
      inward_along<0>(joints, f);
      break;
    case 1:
      inward_along<1>(joints, f);
      break;
    default:
      inward_along<2>(joints, f);
  }
  double a2 = 0, al = 0;
  Found last;
  for (std::size_t l = 0; l < joints.nodes().size(); ++l) {
    const PlanarNode& n = joints.nodes()[l];
    const auto parent = static_cast<std::size_t>(n.parent + 1);
    Node& b = nodes_[l + 1];
    if (parent != l) last = nodes_[parent].found;
    b.found = last = solve(n, b, last, vd);
    const Flat a = at_centre(b);
    a2 = std::max(a2, dot(a, a)), al = std::max(al, std::abs(last.al));
  }
  largest_a_ = std::sqrt(a2), largest_alpha_ = al;
}

void PlanarBodies::accelerations(const JointTree& tree, VecX& a) const {
  a.setZero(6 * tree.n_slots());
  const Plane plane = tree.planar()->plane();
  for (const PlanarNode& n : tree.planar()->nodes()) {
    const Node& b = nodes_[static_cast<std::size_t>(&n - tree.planar()->nodes().data()) + 1];
    const Flat centre = at_centre(b);
    a[6 * n.slot + plane.i()] = centre.i, a[6 * n.slot + plane.j()] = centre.j;
    a.segment<3>(6 * n.slot + 3) = b.found.al * b.normal;
  }
}

}  // namespace lockstep
