#include "framework/dynamics/tree/joint_tree.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <lockstep/lock.h>
#include "framework/dynamics/tree/moving_markers.h"
#include "framework/dynamics/tree/spanning_tree.h"
#include "framework/dynamics/tree/tree_motion.h"
#include "framework/foundation/math/sin_cos.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

namespace {

constexpr double kInPlane = 1e-9;  // sine of the angle by which an axis may lie beside the plane: see System::setup

// The part of a mask that a joint of the tree holds: any translations, and none, two or all of the turns. One turn alone
// has no closed form and stays a row; in a plane it holds the angle or nothing.
Mask closed_form(Mask rows, Plane plane) {
  return plane || count_rows(rows & Mask::e123) != 1 ? rows : rows & Mask::xyz;
}

// Numbers of the rows of a lock that its joint does not hold, a bit for each: rows of its functions come last.
unsigned rows_left(const Lock& lock, Mask held) {
  const Mask rows = lock.jointed()->rows();
  unsigned left = 0;
  int row = 0;
  for (int k = 0; k < 6; ++k)
    if (includes(rows, row_bit(k))) left |= includes(held, row_bit(k)) ? 0U : 1U << row, ++row;
  for (; row < lock.row_count(); ++row) left |= 1U << row;
  return left;
}

// Whether the rows of its mask are the first of a lock.
bool begins_with_mask(const Lock& lock) {
  const Mask rows = lock.jointed()->rows();
  if (lock.row_count() < count_rows(rows)) return false;
  for (int k = 0, row = 0; k < 6; ++k)
    if (includes(rows, row_bit(k)) && lock.row_name(row++) != row_name(k)) return false;
  return true;
}

bool is_particle(const Body& body) { return !body.fixed && body.freedoms == Freedoms::particle; }

bool is_moving(const Marker& m) { return m.translation_law || m.rotation_law; }

// A particle keeps its axes: the ground alone can carry it, and it carries nothing.
std::string refusal_of_particle(const Lock& link) {
  for (const auto& [p, s] : link.pairs())
    for (const auto& [m, other] : {std::pair{p, s}, std::pair{s, p}}) {
      if (!is_particle(*m->body)) continue;
      if (!other->body->fixed)
        return "link '" + link.name() + "' ties the particle '" + m->body->name + "' to a body that moves";
      if (!link.jointed()->imposed().empty() || is_moving(*p) || is_moving(*s))
        return "link '" + link.name() + "' has laws on a particle";
    }
  return "";
}

// Which coordinates a lock leaves free.
struct Free {
  int n_slides = 0;
  std::array<Vec3, 3> slide{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};  // in the axes of the slot that carries S
  TreeTurn turn = TreeTurn::none;
  Vec3 hinge = Vec3::Zero();  // axis of a hinge, in the axes of P and of S
};

Free free_in_space(Mask held, const MarkerFrame& S) {
  Free f;
  for (int k = 0; k < 3; ++k)
    if (!includes(held, row_bit(k))) f.slide[static_cast<std::size_t>(f.n_slides++)] = S.A0.col(k);
  if (!overlaps(held, Mask::e123)) {
    f.turn = TreeTurn::ball;
  } else if (!includes(held, Mask::e123)) {
    f.turn = TreeTurn::hinge;
    f.hinge = Vec3::Unit(!includes(held, Mask::e1) ? 0 : !includes(held, Mask::e2) ? 1 : 2);
  }
  return f;
}

// The axis of the turn in the plane, axes of S; null where rows hold it. A row of one turn does, unless its axis lies in
// the plane.
std::optional<Vec3> hinge_in_plane(Mask held, const MarkerFrame& S, const Vec3& normal) {
  const Free space = free_in_space(held, S);
  if (space.turn == TreeTurn::none) return {};
  const bool alone = count_rows(held & Mask::e123) == 1;
  if (space.turn == TreeTurn::hinge && !alone)
    return are_parallel(Vec3(S.A0 * space.hinge), normal) ? std::optional(space.hinge) : std::nullopt;
  for (int k = 0; k < 3; ++k)
    if (includes(held, row_bit(3 + k)) && !are_perpendicular(S.A0.col(k), normal, kInPlane)) return {};
  return Vec3(S.A0.transpose() * normal);
}

// Of these, those in the plane, in which slot axes are the world's where no slot is turned. Of the axes of S each lies
// in the plane or along the normal, if a row holds it.
Free free_in_plane(Mask held, const MarkerFrame& S, Plane plane) {
  const Free space = free_in_space(held, S);
  const Vec3 normal = Vec3::Unit(plane.n);
  Free f;
  if (const std::optional<Vec3> hinge = hinge_in_plane(held, S, normal)) f.turn = TreeTurn::hinge, f.hinge = *hinge;
  Vec3 held_in = Vec3::Zero();  // a direction in the plane that is held
  int n_held = 0;
  for (int k = 0; k < 3; ++k)
    if (includes(held, row_bit(k)) && are_perpendicular(S.A0.col(k), normal, kInPlane)) held_in = S.A0.col(k), ++n_held;
  for (int k = 0; k < space.n_slides; ++k)
    if (const Vec3& along = space.slide[static_cast<std::size_t>(k)]; are_perpendicular(along, normal, kInPlane))
      f.slide[static_cast<std::size_t>(f.n_slides++)] = along;
  if (f.n_slides == 2 - n_held) return f;
  f.n_slides = 2 - n_held;
  f.slide[0] = n_held == 1 ? Vec3(cross(normal, held_in)) : Vec3(Vec3::Unit(plane.i()));
  f.slide[1] = Vec3::Unit(plane.j());
  return f;
}

// How many coordinates a lock holds; in a plane, of those in it.
int count_held(const Lock& link, Plane plane) {
  const Mask rows = closed_form(link.jointed()->rows(), plane);
  if (!plane) return count_rows(rows);
  const Free f = free_in_plane(rows, MarkerFrame(*link.pairs().front().second), plane);
  return 2 - f.n_slides + (f.turn == TreeTurn::none ? 1 : 0);
}

// Whether markers are turned against each other, out of the plane, by an angle that the lock leaves free.
bool is_tilted(const Lock& link, Plane plane) {
  if (!overlaps(link.jointed()->rows(), Mask::e123)) return false;
  const auto [p, s] = link.pairs().front();
  const Quat turn = MarkerFrame(*s).q0 * conjugate(MarkerFrame(*p).q0);
  return std::hypot(turn.vec()[plane.i()], turn.vec()[plane.j()]) > kInPlane;
}

// Why a link is no tree joint; "" for one that is.
std::string refusal(const Lock& link, Plane plane) {
  const std::string who = "link '" + link.name() + "' ";
  const Jointed* joint = link.jointed();
  if (!joint) return who + "is not a lock of a mask";
  if (link.unilateral()) return who + "is one-sided";
  if (plane)
    for (const auto& [p, s] : link.pairs())
      if (is_moving(*p) || is_moving(*s)) return who + "has a marker that moves on its body";
  if (!begins_with_mask(link) || (plane && link.row_count() != count_rows(joint->rows())))
    return who + "has rows beside those of its mask";
  if (plane && is_tilted(link, plane)) return who + "has markers that are turned against each other out of the plane";
  return refusal_of_particle(link);
}

// What stands in the way of joint coordinates, but for loops; "" for nothing.
std::string obstacle(const System& system) {
  if (system.n_slots() == 0) return "nothing moves";
  for (const auto& force : system.forces())
    if (force->reacting()) return "force '" + force->name() + "' reads reactions";
  for (const auto& link : system.links()) {
    if (system.merged(*link)) continue;
    if (system.left_out(*link) != 0) return "rows of link '" + link->name() + "' that depend on others are left out";
  }
  return {};
}

std::pair<int, int> slots_of(const Lock& link) {
  const auto [p, s] = link.pairs().front();
  return {p->body->slot, s->body->slot};
}

// The links in force: first those of the tree, then the others.
std::pair<std::vector<int>, std::vector<int>> tree_and_closures(const System& system, const std::vector<bool>& modes) {
  std::vector<GraphLink> links;
  for (const auto& link : system.links()) {
    if (system.merged(*link) || !modes[static_cast<std::size_t>(link->number())]) continue;
    const bool is_joint = refusal(*link, system.plane()).empty();
    const int n_held = is_joint ? count_held(*link, system.plane()) : 0;
    if (is_joint && n_held == 0 && system.plane()) continue;
    const auto [a, b] = link->pairs().empty() ? std::pair(kGround, kGround) : slots_of(*link);
    links.push_back({link->number(), a, b, n_held});
  }
  const std::vector<bool> taken = spanning_tree(links, system.n_slots());
  std::pair<std::vector<int>, std::vector<int>> out;
  for (std::size_t i = 0; i < links.size(); ++i) (taken[i] ? out.first : out.second).push_back(links[i].number);
  return out;
}

// Links of the tree as edges between slots.
class Graph {
 public:
  struct Edge {
    int link, other;  // number of the link, the slot at its other end
  };
  Graph(const System& system, const std::vector<int>& links) : edges_(static_cast<std::size_t>(system.n_slots() + 1)) {
    for (const int link : links) {
      const auto [a, b] = slots_of(*system.links()[static_cast<std::size_t>(link)]);
      edges_[at(a)].push_back({link, b});
      edges_[at(b)].push_back({link, a});
    }
  }
  const std::vector<Edge>& of(int slot) const { return edges_[at(slot)]; }

 private:
  static std::size_t at(int slot) { return static_cast<std::size_t>(slot + 1); }  // the ground first
  std::vector<std::vector<Edge>> edges_;
};

}  // namespace

std::shared_ptr<const JointTree> JointTree::of(const System& system, const std::vector<bool>& modes,
                                               std::string& why_not) {
  why_not = obstacle(system);
  if (!why_not.empty()) return nullptr;
  const auto tree = std::make_shared<JointTree>();
  tree->node_of_.assign(static_cast<std::size_t>(system.n_slots()), -1);
  const auto [joints, others] = tree_and_closures(system, modes);
  tree->closures_ = others, tree->has_rows_ = tree->may_be_redundant_ = !others.empty();
  tree->grow(system, Graph(system, joints));
  if (tree->n_v_ > 0)
    for (const TreeNode& n : tree->nodes_)
      if (n.has_laws()) tree->followed_.push_back(n.slot);
  tree->planar_ = PlanarJoints::of(tree->nodes_, system.plane());
  why_not = tree->follow_turns(system);
  if (!why_not.empty()) return nullptr;
  if (system.plane() && !tree->planar_)
    why_not = "a law does not say that it stays in the plane (stays_in_plane, turns_about)";
  else if (tree->n_v_ == 0 && tree->has_rows_)
    why_not = "no coordinate is free, but link '" + tree->link_with_rows(system).name() + "' has rows";
  return why_not.empty() ? tree : nullptr;
}

// The first link that closes a loop, or whose joint leaves rows.
const Lock& JointTree::link_with_rows(const System& system) const {
  if (!closures_.empty()) return *system.links()[static_cast<std::size_t>(closures_.front())];
  return *std::ranges::find_if(nodes_, [](const TreeNode& n) { return n.left != 0; })->lock;
}

// Depth first from the ground, then from every slot that no link has reached: it is free.
template <class G>
void JointTree::grow(const System& system, const G& graph) {
  struct Open {
    int slot, parent, link;  // the slot, its parent's node, the link between them
  };
  std::vector<Open> open;
  nodes_.reserve(static_cast<std::size_t>(system.n_slots()));
  const auto hang_on = [&](int slot, int node, int by) {
    for (auto e = graph.of(slot).rbegin(); e != graph.of(slot).rend(); ++e)
      if (e->link != by) open.push_back({e->other, node, e->link});
  };
  hang_on(kGround, -1, -1);
  for (int next = 0;;) {
    while (!open.empty()) {
      const Open o = open.back();
      open.pop_back();
      add_node(system, o.slot, o.parent, o.link);
      hang_on(o.slot, static_cast<int>(nodes_.size()) - 1, o.link);
    }
    while (next < system.n_slots() && node_of_[static_cast<std::size_t>(next)] >= 0) ++next;
    if (next == system.n_slots()) return;
    open.push_back({next, -1, -1});
  }
}

void JointTree::add_node(const System& system, int slot, int parent, int link) {
  TreeNode node;
  node.slot = slot, node.parent = parent, node.link = link;
  node.first_q = n_q_, node.first_v = n_v_;
  Mask held = Mask::none;
  MarkerFrame P, S;
  if (link < 0) {
    P.slot = slot;  // the slot's own frame, seen from the world's
  } else {
    const Lock& lock = *system.links()[static_cast<std::size_t>(link)];
    const auto [p, s] = lock.pairs().front();
    P = MarkerFrame(*p), S = MarkerFrame(*s);
    held = closed_form(lock.jointed()->rows(), system.plane());
    node.left = rows_left(lock, held);
    has_rows_ = has_rows_ || node.left != 0;
    for (int row = 0; row < lock.row_count(); ++row)
      may_be_redundant_ =
          may_be_redundant_ || ((node.left >> row & 1U) != 0 && lock.row_kind(row) == RowKind::function);
    if (const ImposedMotion& laws = lock.jointed()->imposed(); !laws.empty()) {
      node.imposed = std::make_shared<const ImposedMotion>(laws);
      node.first_s = lock.first_state(), node.n_s = lock.n_own_states();
    }
    node.lock = &lock, node.rows = held;
    has_laws_ = has_laws_ || node.imposed || is_moving(*p) || is_moving(*s);
    if (is_moving(*p) || is_moving(*s))
      node.moving = std::make_shared<const MovingMarkers>(P.slot == slot ? MovingMarkers{S, P} : MovingMarkers{P, S});
  }
  if (system.slot(slot).freedoms == Freedoms::particle) {  // its axes are those of the world
    held = held | Mask::e123;
    P.q0 = S.q0;
  }
  node.reversed = P.slot != slot;
  const Free free = system.plane() ? free_in_plane(held, S, system.plane()) : free_in_space(held, S);
  if (system.plane() && !overlaps(held, Mask::e123))
    P.q0 = S.q0, P.A0 = S.A0;  // the angle is zero where the slots' axes agree
  const MarkerFrame &near = node.reversed ? P : S, &far = node.reversed ? S : P;
  const double sign = node.reversed ? -1.0 : 1.0;
  node.near_u = near.u0, node.near_q = near.q0, node.far_u = far.u0, node.far_q = far.q0;
  node.K0 = near.q0 * conjugate(far.q0);
  node.n_slides = free.n_slides, node.turn = free.turn;
  if (node.n_slides > 0 || node.turn == TreeTurn::ball) {
    TreeAxes axes;
    for (std::size_t k = 0; k < 3; ++k) axes.slide[k] = sign * free.slide[k];
    if (node.turn == TreeTurn::ball) axes.ball = sign * P.A0;
    node.axes = std::make_shared<const TreeAxes>(axes);
  }
  if (node.turn == TreeTurn::hinge) {
    node.hinge = free.hinge;
    node.axis = sign * (near.A0 * node.hinge);
    node.K1 = near.q0 * Quat::from(0.0, Vec3(sign * node.hinge)) * conjugate(far.q0);
  }
  n_q_ += node.n_q(), n_v_ += node.n_v();
  node_of_[static_cast<std::size_t>(slot)] = static_cast<int>(nodes_.size());
  nodes_.push_back(node);
}

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
    carry(node, now, y, {half.cosine(), half.sine()}, p, p.A * p.w, out[motion_of(node)]);
  }
}

void laws_at(const TreeNode& n, double t, const VecX& s, Imposed& now) {
  const std::span<const double> own =
      n.n_s > 0 ? std::span<const double>(s.data() + n.first_s, static_cast<std::size_t>(n.n_s))
                : std::span<const double>();
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
  std::vector<const TreeNode*> path;
  for (int k = node_of_[static_cast<std::size_t>(slot)]; k >= 0; k = path.back()->parent)
    path.push_back(&nodes_[static_cast<std::size_t>(k)]);
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

// An angle of 1000 turns is known to 1e-12 rad. Twice a whole number of turns leaves the sign of quaternions.
bool JointTree::take_off_turns(State& y) const {
  constexpr double kMost = 1000 * kTwoPi, kTwoTurns = 2 * kTwoPi,
                   kLow = 4.8985871965894128e-16;  // 4 pi less kTwoTurns
  bool any = false;
  for (const TreeNode& node : nodes_) {
    if (node.turn != TreeTurn::hinge) continue;
    double& angle = y.q[node.first_q + node.n_slides];
    if (!(std::abs(angle) > kMost)) continue;
    const double n = std::round(angle / kTwoTurns);
    angle = std::fma(-n, kTwoTurns, angle) - n * kLow;
    any = true;
  }
  return any;
}

namespace {

// Where laws alone move the slots.
void vary_driven(const StateRate& d, VecX& dx, VecX& dv) {
  if (d.q.size() == dx.size() && d.v.size() == dv.size())
    dx = d.q, dv = d.v;
  else
    dx.setZero(), dv.setZero();
}

}  // namespace

void JointTree::variations(const State& y, std::span<const Motion> at, const StateRate& d, VecX& dx, VecX& dv) const {
  const auto n = static_cast<Eigen::Index>(nodes_.size());
  dx.resize(6 * n), dv.resize(6 * n);
  if (n_v_ == 0) return vary_driven(d, dx, dv);
  for (const TreeNode& node : nodes_) {
    NodeVariation p;
    if (node.parent >= 0) {
      const int slot = nodes_[static_cast<std::size_t>(node.parent)].slot;
      p = {dx.segment<3>(6 * slot), dx.segment<3>(6 * slot + 3), dv.segment<3>(6 * slot), dv.segment<3>(6 * slot + 3)};
    }
    const Motion& parent = at[motion_of(node.parent)];
    const NodeVariation own =
        node.moving ? vary_moving(node, y, d, parent, p) : vary(node, y, d, parent, at[motion_of(node)], p);
    dx.segment<3>(6 * node.slot) = own.x, dx.segment<3>(6 * node.slot + 3) = own.phi;
    dv.segment<3>(6 * node.slot) = own.v, dv.segment<3>(6 * node.slot + 3) = own.w;
  }
}

namespace {

// Writes the coordinates of a turn r, with the rates of its axes; an angle within half a turn of that of `near`.
void write_turn(const TreeNode& node, const Quat& r, const Vec3& rates, const State* near, State& out) {
  const int at_q = node.first_q + node.n_slides, at_v = node.first_v + node.n_slides;
  if (node.turn == TreeTurn::hinge) {
    const double angle = 2.0 * std::atan2(r.vec().dot(node.hinge), r.w), about = near ? near->q[at_q] : 0.0;
    out.q[at_q] = angle + kTwoPi * std::round((about - angle) / kTwoPi);
    out.v[at_v] = rates[0];
  } else if (node.turn == TreeTurn::ball) {
    out.q.segment<4>(at_q) = r.coefficients();
    out.v.segment<3>(at_v) = rates;
  }
}

}  // namespace

// The pose of far seen from near: r and rho of P seen from S, or their inverse.
void JointTree::read_off(const State& slots, const State* near, State& out) const {
  out.q.resize(n_q_), out.v.resize(n_v_);
  out.t = slots.t, out.s = slots.s, out.z = slots.z, out.modes = slots.modes, out.watched = slots.watched;
  for (const TreeNode& node : nodes_) {
    Motion p;
    if (node.parent >= 0) p = slot_motion(slots, nodes_[static_cast<std::size_t>(node.parent)].slot);
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
    const Vec3 law = node.imposed ? Vec3(slide_axes(node, p, own) * now.w) : Vec3::Zero();
    const Vec3 turn = turn_axes(node, now, p, own).transpose() * (w - wp - law);
    write_turn(node, r, turn, near, out);
  }
}

}  // namespace lockstep
