#include "framework/dynamics/tree/planar_bodies.h"

#include <algorithm>

#include "framework/dynamics/tree/recursion_of.h"
#include "framework/foundation/math/sin_cos.h"

namespace lockstep {

PlanarBodies::PlanarBodies(const JointTree& tree, const System& system, bool) {
  const std::vector<PlanarNode>& nodes = tree.planar()->nodes();
  const std::size_t n = nodes.size();
  plane_i_ = static_cast<std::size_t>(tree.planar()->plane().i());
  plane_j_ = static_cast<std::size_t>(tree.planar()->plane().j()), plane_n_ = 3 - plane_i_ - plane_j_;
  nodes_.assign(n + 1, Node());
  slides_.resize(static_cast<std::size_t>(tree.n_v()));
  std::vector<int> parents;
  for (const PlanarNode& t : nodes) parents.push_back(t.parent);
  std::size_t n_waiting = 0;
  const std::vector<InwardPlace> places = inward_places(parents, n_waiting);
  for (std::size_t k = 0; k < n; ++k) {
    const PlanarNode& t = nodes[k];
    const Slot& slot = system.slot(t.slot);
    Node& b = nodes_[k + 1];
    const Vec3 normal = tree.planar()->normal(t);
    b.m = slot.mass, b.J = normal.dot(slot.J * normal);
    static_cast<InwardPlace&>(b) = places[k];
  }
  waiting_.assign(n_waiting, Inertia());
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
  SinCosAhead half;
  for (std::size_t l = 0; l < nodes.size(); ++l) {
    half.see(
        l, nodes.size(), [&](std::size_t i) __attribute__((always_inline)) {
          return half_turn(nodes[i], y.q.data() + nodes[i].first_q);
        });
    const PlanarNode& n = nodes[l];
    const Node& p = nodes_[static_cast<std::size_t>(n.parent + 1)];
    Node& b = nodes_[l + 1];
    PlanarImposed now;
    if (n.law >= 0) now = planar_laws_at(tree.nodes()[l], joints.law(n), y.t, y.s);
    const double *q = y.q.data() + n.first_q, *v = y.v.data() + n.first_v;
    const PlanarCarried add = carry(n, n.law < 0 ? nullptr : &now, half.cosine(), half.sine(), q, v, p.frame, b.frame);
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

LOCKSTEP_INLINE void PlanarBodies::Inertia::add_row(const FlatWrench& K, double l, double d_1) {
  const Flat f = d_1 * K.f;
  const double t = d_1 * K.t;
  Mii += f.i * K.f.i, Mij += f.i * K.f.j, Mjj += f.j * K.f.j, h += t * K.f, I += t * K.t;
  p += l * f, tau += l * t;
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
  b.g = D_1 * h, b.gs = D_1 * hs, b.u = D_1 * u, b.D_1 = D_1;
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
    b.g = D_1 * IA.h, b.u = -D_1 * IA.tau, b.D_1 = D_1;
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

LOCKSTEP_INLINE FlatWrench& operator+=(FlatWrench& a, const FlatWrench& b) {
  a.f += b.f, a.t += b.t;
  return a;
}
LOCKSTEP_INLINE FlatWrench& operator-=(FlatWrench& a, const FlatWrench& b) {
  a.f -= b.f, a.t -= b.t;
  return a;
}
LOCKSTEP_INLINE FlatWrench operator*(double x, const FlatWrench& a) { return {x * a.f, x * a.t}; }
LOCKSTEP_INLINE double dot(const FlatWrench& a, const FlatTwist& b) { return dot(a.f, b.a) + a.t * b.al; }
LOCKSTEP_INLINE double force2(const FlatWrench& a) { return dot(a.f, a.f); }
LOCKSTEP_INLINE double moment2(const FlatWrench& a) { return a.t * a.t; }
LOCKSTEP_INLINE double linear2(const FlatTwist& a) { return dot(a.a, a.a); }
LOCKSTEP_INLINE double angular2(const FlatTwist& a) { return a.al * a.al; }

// What eliminate() and shift() do with IA, here with K: its rows are K' / D^-1 once the coordinates are gone. Of a hinge
// u, g and gs are about the parent's point already.
LOCKSTEP_INLINE void PlanarBodies::Joint::pass(FlatWrench& K, double& l, double* kappa, double* V) const {
  const Flat s = across(b.r);
  const int turn = n_slides;
  if (turns) {
    const double t = kappa[turn] = K.t;
    V[turn] = t * b.D_1;
    l += t * b.u;
    if (turn == 0) {
      l += dot(K.f, b.ca);
      K.t = dot(K.f, s) - t * b.gs;
      K.f -= t * b.g;
      return;
    }
    K.f -= t * b.g, K.t = 0;
  }
  for (int i = 0; i < n_slides; ++i) {
    const Slide& slide = slides[i];
    kappa[i] = dot(K.f, slide.l), V[i] = kappa[i] * slide.D_1;
    l += V[i] * slide.u;
    K.f -= V[i] * slide.U, K.t -= V[i] * slide.U_turn;
  }
  l += dot(K.f, b.ca) + K.t * b.cal;
  K.t += dot(K.f, s);
}

// u = -S' p, p <- p + U D^-1 u, one coordinate after another, then about the parent's point
LOCKSTEP_INLINE void PlanarBodies::Joint::pass_again(FlatWrench& p, double* u) const {
  const Flat s = across(b.r);
  if (turns) {
    const double x = u[n_slides] = -p.t;
    if (n_slides == 0) {
      p.t = dot(s, p.f) + x * b.gs, p.f += x * b.g;
      return;
    }
    p.f += x * b.g, p.t = 0;
  }
  for (int i = 0; i < n_slides; ++i) {
    u[i] = -dot(slides[i].l, p.f);
    const double x = slides[i].D_1 * u[i];
    p.f += x * slides[i].U, p.t += x * slides[i].U_turn;
  }
  p.t += dot(s, p.f);
}

// As solve(), without accelerations that the velocities and laws make.
LOCKSTEP_INLINE FlatTwist PlanarBodies::Joint::solve_again(const FlatTwist& p, const double* u, const double* less,
                                                           double* dv) const {
  const int turn = n_slides;
  FlatTwist own{p.a + p.al * across(b.r), p.al};
  for (int i = n_slides; i-- > 0;) {
    const Slide& slide = slides[i];
    dv[i] = slide.D_1 * (u[i] - dot(slide.U, own.a) - slide.U_turn * own.al) - (less ? less[i] : 0.0);
    own.a += dv[i] * slide.l;
  }
  if (!turns) return own;
  const double by_parent = turn == 0 ? dot(b.g, p.a) + b.gs * p.al : dot(b.g, own.a);
  own.al = b.D_1 * u[turn] - by_parent - (less ? less[turn] : 0.0);
  dv[turn] = sign * (own.al - p.al);
  return own;
}

LOCKSTEP_INLINE FlatWrench PlanarBodies::read_side(const RowView& rows, int i, int k, std::size_t node,
                                                   const Motion& motion, double& diagonal) const {
  const Node& b = nodes_[node + 1];
  std::array<double, 3> J;
  if (rows.layout() == RowLayout::planar || rows.layout() == RowLayout::pair) {
    J = rows.J_in_plane(i, k);
  } else {
    const std::array<double, 6> all = rows.J(i, k);
    const Vec3 normal = motion.A.row(static_cast<Eigen::Index>(plane_n_));  // in slot axes
    J = {all[plane_i_], all[plane_j_], normal.dot(Vec3(all[3], all[4], all[5]))};
  }
  diagonal += (J[0] * J[0] + J[1] * J[1]) / b.m;
  if (b.J > 0) diagonal += J[2] * J[2] / b.J;  // else a particle
  return {{J[0], J[1]}, J[2]};
}

// The mass centre has a + al n x d - w^2 d.
LOCKSTEP_INLINE double PlanarBodies::move_to_joint(std::size_t node, FlatWrench& K) const {
  const Node& b = nodes_[node + 1];
  K.t += dot(K.f, across(b.d));
  return -b.frame.w * b.frame.w * dot(K.f, b.d);
}

// Of a slot about its joint's point: M = m 1, h = m n x d, I = J + m d^2, p = -m w^2 d - f, tau = d x p - moment.
template <int k, class Rows>
LOCKSTEP_INLINE void PlanarBodies::inward_along(const PlanarJoints& joints, const VecX& f, Rows& rows) {
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
    const double moment = n.posture < 0 ? on[3 + k] : joints.posture(n)->normal.dot(Vec3(on[3], on[4], on[5]));
    IA.Mii += b.m, IA.Mjj += b.m, IA.h += h, IA.p += p;
    IA.I += b.J + dot(e, h), IA.tau += dot(e, p) - moment;
    rows.close(l, IA);
    if (is_hinge(n)) {
      pass_hinge(b, IA);
      rows.pass_on(l, 1, Joint{b, nullptr, 0, true, n.sign});
    } else {
      eliminate(n, b, IA);
      rows.pass_on(l, n.n_slides + (n.turns ? 1 : 0), joint(n, b));
      shift(b, IA);
    }
    if (b.to >= 0) waiting_[static_cast<std::size_t>(b.to)].add(IA);
  }
}

// a' = a_p + al_p x r + ca, al' = al_p + cal; who was eliminated last comes first: qdd = D^-1 (u - U' a') - less; less:
// V' lambda of closures, null without
LOCKSTEP_INLINE FlatTwist PlanarBodies::solve(const PlanarNode& n, const Node& b, const FlatTwist& p,
                                              const double* less, VecX& vd) const {
  FlatTwist own{p.a + (p.al * across(b.r) + b.ca), p.al + b.cal};
  const double before = own.al;
  if (is_hinge(n)) {
    own.al = b.u - dot(b.g, p.a) - b.gs * p.al;
    if (less) own.al -= less[0];
    vd[n.first_v] = n.sign * (own.al - before);
    return own;
  }
  for (int i = n.n_slides; i-- > 0;) {
    const Slide& s = slides_[static_cast<std::size_t>(n.first_v + i)];
    double x = s.D_1 * (s.u - dot(s.U, own.a) - s.U_turn * own.al);
    if (less) x -= less[i];
    vd[n.first_v + i] = x;
    own.a += x * s.l;
  }
  if (!n.turns) return own;
  own.al = b.u - dot(b.g, own.a);
  if (less) own.al -= less[n.n_slides];
  vd[n.first_v + n.n_slides] = n.sign * (own.al - before);
  return own;
}

template <class Rows>
LOCKSTEP_INLINE void PlanarBodies::accelerate_with(const JointTree& tree, const VecX& f, Rows& rows, VecX& vd) {
  vd.resize(tree.n_v());
  const PlanarJoints& joints = *tree.planar();
  switch (joints.plane().n) {
    case 0:
      inward_along<0>(joints, f, rows);
      break;
    case 1:
      inward_along<1>(joints, f, rows);
      break;
    default:
      inward_along<2>(joints, f, rows);
  }
  rows.close_at_ground();
  Largest most;
  FlatTwist last;
  for (std::size_t l = 0; l < joints.nodes().size(); ++l) {
    const PlanarNode& n = joints.nodes()[l];
    const auto parent = static_cast<std::size_t>(n.parent + 1);
    Node& b = nodes_[l + 1];
    if (parent != l) last = nodes_[parent].found;
    b.found = last = solve(n, b, last, rows.less(l, n.n_slides + (n.turns ? 1 : 0)), vd);
    rows.find(l, last);
    b.centre = at_centre(b);
    most.add(dot(b.centre, b.centre), last.al * last.al);
  }
  largest_ = most;
}

LOCKSTEP_FLAT_CLONES void PlanarBodies::accelerate(const JointTree& tree, std::span<const Motion>, const VecX& f,
                                                   VecX& vd) {
  NoClosures none;
  accelerate_with(tree, f, none, vd);
}

LOCKSTEP_FLAT_CLONES void PlanarBodies::accelerate(const JointTree& tree, std::span<const Motion>, const VecX& f,
                                                   Closures& closures, VecX& vd) {
  accelerate_with(tree, f, closures, vd);
}

void PlanarBodies::follow(const JointTree& tree) {
  for (const PlanarNode& n : tree.planar()->nodes()) {
    const FlatTwist& p = nodes_[static_cast<std::size_t>(n.parent + 1)].found;
    Node& b = nodes_[static_cast<std::size_t>(&n - tree.planar()->nodes().data()) + 1];
    b.found = {p.a + (p.al * across(b.r) + b.ca), p.al + b.cal};
  }
  find_largest();
}

void PlanarBodies::add(const Closures& closures) {
  for (std::size_t k = 0; k + 1 < nodes_.size(); ++k) {
    FlatTwist& own = nodes_[k + 1].found;
    own.a += closures.change(k).a, own.al += closures.change(k).al;
  }
  find_largest();
}

void PlanarBodies::find_largest() {
  largest_ = {};
  for (std::size_t k = 1; k < nodes_.size(); ++k) {
    Node& b = nodes_[k];
    b.centre = at_centre(b);
    largest_.add(dot(b.centre, b.centre), b.found.al * b.found.al);
  }
}

// Against the parent, beyond what the velocities make.
void PlanarBodies::read_off(const JointTree& tree, std::span<const Motion>, const VecX& a, VecX& vd) {
  vd.resize(tree.n_v());
  const PlanarJoints& joints = *tree.planar();
  const Plane plane = joints.plane();
  for (std::size_t l = 0; l < joints.nodes().size(); ++l) {
    const PlanarNode& n = joints.nodes()[l];
    const FlatTwist& p = nodes_[static_cast<std::size_t>(n.parent + 1)].found;
    Node& b = nodes_[l + 1];
    const double* of = a.data() + 6 * n.slot;
    b.found.al = joints.normal(n).dot(Vec3(of[3], of[4], of[5]));
    b.found.a = Flat{of[plane.i()], of[plane.j()]} - (b.found.al * across(b.d) - (b.frame.w * b.frame.w) * b.d);
    if (n.turns) vd[n.first_v + n.n_slides] = n.sign * (b.found.al - p.al - b.cal);
    const Flat da = b.found.a - (p.a + (p.al * across(b.r) + b.ca));
    for (int i = 0; i < n.n_slides; ++i)
      vd[n.first_v + i] = dot(slides_[static_cast<std::size_t>(n.first_v + i)].l, da);
  }
  find_largest();
}

void PlanarBodies::accelerations(const JointTree& tree, std::span<const Motion>, VecX& a) const {
  a.setZero(6 * tree.n_slots());
  const Plane plane = tree.planar()->plane();
  for (const PlanarNode& n : tree.planar()->nodes()) {
    const Node& b = nodes_[static_cast<std::size_t>(&n - tree.planar()->nodes().data()) + 1];
    a[6 * n.slot + plane.i()] = b.centre.i, a[6 * n.slot + plane.j()] = b.centre.j;
    a.segment<3>(6 * n.slot + 3) = b.found.al * tree.planar()->normal(n);
  }
}

template class RecursionOf<PlanarBodies>;

}  // namespace lockstep
