// SPDX-License-Identifier: BSD-3-Clause
// A tree is grown: its joints, and what prevents it. States along it: tree_states.cpp.
#include "framework/dynamics/tree/joint_tree.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <lockstep/text.h>
#include "framework/dynamics/tree/moving_markers.h"
#include "framework/dynamics/tree/spanning_tree.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

namespace {

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

bool is_moving(const Marker& m) { return m.translation_law || m.rotation_law; }

// A particle keeps its axes: the ground alone can carry it, and it carries nothing.
std::string refusal_of_particle(const Lock& link) {
  for (const auto& [p, s] : link.pairs())
    for (const auto& [m, other] : {std::pair{p, s}, std::pair{s, p}}) {
      if (m->body->fixed || m->body->freedoms != Freedoms::particle) continue;
      if (!other->body->fixed)
        return "joint '" + link.name() + "' connects the particle '" + m->body->name + "' to a moving body";
      if (!link.jointed()->imposed().empty() || is_moving(*p) || is_moving(*s))
        return "joint '" + link.name() + "' has laws on a particle";
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
    if (!includes(held, row_bit(k))) f.slide[f.n_slides++] = S.A0.col(k);
  if (!overlaps(held, Mask::e123)) {
    f.turn = TreeTurn::ball;
  } else if (!includes(held, Mask::e123)) {
    f.turn = TreeTurn::hinge;
    f.hinge = Vec3::Unit(!includes(held, Mask::e1) ? 0 : !includes(held, Mask::e2) ? 1 : 2);
  }
  return f;
}

// The axis of the turn in the plane, axes of S; null if rows hold it. A row of one turn does, unless its axis lies in
// the plane.
std::optional<Vec3> hinge_in_plane(Mask held, const MarkerFrame& S, const Vec3& normal) {
  const Free space = free_in_space(held, S);
  if (space.turn == TreeTurn::none) return {};
  const bool alone = count_rows(held & Mask::e123) == 1;
  const Vec3 in_S = S.A0.transpose() * normal;
  if (space.turn == TreeTurn::hinge && !alone) {
    if (!are_parallel(in_S, space.hinge)) return {};
    return Vec3(in_S.dot(space.hinge) > 0 ? in_S : -in_S);
  }
  for (int k = 0; k < 3; ++k)
    if (includes(held, row_bit(3 + k)) && !are_perpendicular(S.A0.col(k), normal)) return {};
  return in_S;
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
    if (includes(held, row_bit(k)) && are_perpendicular(S.A0.col(k), normal)) held_in = S.A0.col(k), ++n_held;
  for (int k = 0; k < space.n_slides; ++k)
    if (const Vec3& along = space.slide[k]; are_perpendicular(along, normal))
      f.slide[f.n_slides++] = (along - along.dot(normal) * normal).normalized();
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
  return std::hypot(turn.vec()[plane.i()], turn.vec()[plane.j()]) > kParallel;
}

// Why a link is no tree joint; "" for one that is.
std::string refusal(const Lock& link, Plane plane) {
  const auto who = [&](const char* what) { return "joint '" + link.name() + "' " + what; };
  const Jointed* joint = link.jointed();
  if (!joint) return who("is not a joint with a mask");
  if (link.unilateral()) return who("is one-sided");
  if (joint->imposed().hold) return who("holds the pose of its activation");
  if (plane)
    for (const auto& [p, s] : link.pairs())
      if (is_moving(*p) || is_moving(*s)) return who("has a marker that moves on its body");
  if (!begins_with_mask(link) || (plane && link.row_count() != count_rows(joint->rows())))
    return who("has constraints in addition to those of its mask");
  if (plane && is_tilted(link, plane)) return who("has markers rotated relative to each other out of the plane");
  return refusal_of_particle(link);
}

// What prevents joint coordinates, except loops; "" if nothing does.
std::string obstacle(const System& system) {
  if (system.n_slots() == 0) return "nothing moves";
  for (const auto& force : system.forces())
    if (force->reacting()) return "force '" + force->name() + "' reads reactions";
  std::vector<std::string> names;
  for (const auto& link : system.links())
    if (!system.merged(*link) && system.left_out(*link) != 0) names.push_back("'" + link->name() + "'");
  if (names.empty()) return {};
  return std::string("redundant constraints of joint") + (names.size() > 1 ? "s " : " ") + text::join(names) +
         " are left out";
}

std::pair<int, int> slots_of(const Lock& link) {
  const auto [p, s] = link.pairs().front();
  return {p->body->slot, s->body->slot};
}

// The links in force: first those of the tree, then the others.
std::pair<std::vector<int>, std::vector<int>> tree_and_closures(const System& system, const std::vector<bool>& modes) {
  std::vector<GraphLink> links;
  for (const auto& link : system.links()) {
    if (system.merged(*link) || !modes[link->number()]) continue;
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
      const auto [a, b] = slots_of(*system.links()[link]);
      edges_[at(a)].push_back({link, b}), edges_[at(b)].push_back({link, a});
    }
  }
  const auto& of(int slot) const { return edges_[at(slot)]; }

 private:
  static std::size_t at(int slot) { return slot + 1; }  // the ground first
  std::vector<boost::container::small_vector<Edge, 4>> edges_;
};

}  // namespace

std::shared_ptr<const JointTree> JointTree::of(const System& system, const std::vector<bool>& modes,
                                               std::string& why_not) {
  why_not = obstacle(system);
  if (!why_not.empty()) return nullptr;
  const auto tree = std::make_shared<JointTree>();
  tree->node_of_.assign(system.n_slots(), -1);
  const auto [joints, others] = tree_and_closures(system, modes);
  tree->closures_ = others, tree->has_rows_ = tree->may_be_redundant_ = !others.empty();
  tree->grow(system, Graph(system, joints));
  for (const TreeNode& n : tree->nodes_)
    if (n.has_laws() || tree->n_v_ == 0) tree->followed_.push_back(n.slot);
  tree->planar_ = PlanarJoints::of(tree->nodes_, system.plane());
  why_not = tree->refusal_of_memories(system);
  if (!why_not.empty()) return nullptr;
  if (system.plane() && !tree->planar_)
    why_not = "a law does not declare that it stays in the plane (stays_in_plane, turns_about)";
  else if (tree->n_v_ == 0 && tree->has_rows_)
    why_not = "no coordinate is free, but joint '" + tree->link_with_rows(system).name() + "' has constraints";
  return why_not.empty() ? tree : nullptr;
}

// Of links whose rows read a memory; "" if there is none.
std::string JointTree::refusal_of_memories(const System& system) const {
  const auto reads_memory = [&](int link) { return system.links()[link]->n_own_memory() > 0; };
  const auto refused = [&](int link) {
    return "joint '" + system.links()[link]->name() +
           "' keeps a memory from step to step (ways), which long steps would lose";
  };
  if (const auto link = std::ranges::find_if(closures_, reads_memory); link != closures_.end()) return refused(*link);
  for (const TreeNode& n : nodes_)
    if (n.left != 0 && reads_memory(n.link)) return refused(n.link);
  return {};
}

// The first link that closes a loop, or whose joint leaves rows.
const Lock& JointTree::link_with_rows(const System& system) const {
  if (!closures_.empty()) return *system.links()[closures_.front()];
  return *std::ranges::find_if(nodes_, [](const TreeNode& n) { return n.left != 0; })->lock;
}

// Depth first from the ground, then from every slot that no link has reached: it is free.
template <class G>
void JointTree::grow(const System& system, const G& graph) {
  struct Open {
    int slot, parent, link;  // the slot, its parent's node, the link between them
  };
  std::vector<Open> open;
  nodes_.reserve(system.n_slots());
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
    while (next < system.n_slots() && node_of_[next] >= 0) ++next;
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
    const Lock& lock = *system.links()[link];
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
  node.n_slides = static_cast<unsigned char>(free.n_slides), node.turn = free.turn;
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
  match_sign(system, node);
  n_q_ += node.n_q(), n_v_ += node.n_v();
  node_of_[slot] = static_cast<int>(nodes_.size());
  nodes_.push_back(std::move(node));
}

// The axes of near have two quaternions: taken is the one by which the slot has that of its pose at the start, not its
// negative.
void JointTree::match_sign(const System& system, TreeNode& node) const {
  Quat near = node.near_q, far = node.far_q, law;
  if (node.has_laws()) try {
      const VecX s = node.n_s > 0 ? system.start().s : VecX();
      if (node.moving) {
        const JointLaws now = joint_laws_at(node, 0, s);
        near = now.near.q, far = now.far.q, law = now.D.q;
      } else {
        Imposed now;
        laws_at(node, 0, s, now), law = now.q;
      }
    } catch (const Error&) {  // not defined at the start, where its link is not in force
      return;
    }
  const Quat parent = node.parent < 0 ? Quat{} : system.slot(nodes_[node.parent].slot).home.q,
             r = conjugate(near) * (conjugate(parent) * system.slot(node.slot).home.q) * far;
  if ((conjugate(law) * (node.reversed ? conjugate(r) : r)).w >= 0) return;
  node.near_q = -node.near_q, node.K0 = -node.K0, node.K1 = -node.K1;
  if (!node.moving) return;
  MovingMarkers markers = *node.moving;
  markers.near.q0 = -markers.near.q0;
  node.moving = std::make_shared<const MovingMarkers>(std::move(markers));
}

}  // namespace lockstep
