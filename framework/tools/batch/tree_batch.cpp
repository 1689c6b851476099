// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/batch/batch.h"

#include <algorithm>
#include <cmath>

#include <lockstep/author/lock.h>
#include <lockstep/body.h>
#include "framework/dynamics/evaluate/slot_coordinates.h"
#include "framework/dynamics/solvers/graph.h"
#include "framework/dynamics/tree/moving_markers.h"
#include "framework/dynamics/tree/slender_bodies.h"
#include "framework/dynamics/tree/tree_motion.h"

namespace lockstep::lanes {
namespace {

// Why a tree cannot be vectorised; "" if it can.
std::string why_no_lanes(const TreeLayout& layout, const System& system) {
  if (layout.tree->n_v() == 0) return "it is moved by laws alone, no coordinate is free";
  for (const auto& force : system.forces())
    if (system.plane() && !force->stays_in_plane(system.plane()))
      return "force '" + force->name() + "' does not declare that it stays in the plane of the system";
  return "";
}

bool has_equal_joints(const JointTree& a, const JointTree& b) {
  return std::ranges::equal(a.nodes(), b.nodes(), [](const TreeNode& x, const TreeNode& y) {
    return x.slot == y.slot && x.parent == y.parent && x.link == y.link && x.n_slides == y.n_slides &&
           x.turn == y.turn && x.reversed == y.reversed && x.rows == y.rows && !x.imposed == !y.imposed &&
           !x.moving == !y.moving;
  });
}

// The normal of the plane in which a tree moves with the rows that close its loops, where the axes of its slots lie along it;
// -1: in space.
int plane_of(const TreeLayout& layout) {
  const PlanarJoints* const planar = layout.tree->planar();
  const bool rows_lie_in = layout.fronts.sources.empty() || layout.fronts.in_plane;
  if (!planar || !rows_lie_in) return -1;
  const auto lies_along = [](const PlanarNode& n) { return n.posture < 0; };
  return std::ranges::all_of(planar->nodes(), lies_along) ? planar->plane().n : -1;
}

// The plan of copies of a tree of this shape.
TreePlan make_plan(const JointTree& tree, int normal) {
  TreePlan plan;
  plan.normal = normal;
  plan.n_q = static_cast<std::size_t>(tree.n_q()), plan.n_v = static_cast<std::size_t>(tree.n_v());
  for (const TreeNode& t : tree.nodes()) {
    LaneNode n;
    n.parent = t.parent, n.slot = t.slot;
    n.q = static_cast<std::size_t>(t.first_q), n.v = static_cast<std::size_t>(t.first_v);
    n.n_slides = t.n_slides, n.turn = t.turn, n.reversed = t.reversed;
    n.moving = t.moving != nullptr, n.has_law = t.imposed && !n.moving;
    n.joint = joint::size * plan.nodes.size();
    if (n.needs_more()) n.more = plan.size_more, plan.size_more += more::size;
    if (n.has_law || n.moving) n.law = plan.size_law, plan.size_law += n.moving ? marked::size : imposed::size;
    for (int axis = 0, k = 0; n.moving && axis < 3; ++axis)
      if (!includes(t.rows, row_bit(axis))) n.slides[k++] = axis;
    plan.nodes.push_back(n);
  }
  const std::vector<InwardPlace> places = inward_places(plan.nodes, plan.n_waiting);
  for (std::size_t k = 0; k < places.size(); ++k) static_cast<InwardPlace&>(plan.nodes[k]) = places[k];
  return plan;
}

// Writes a translation and its rates, and the turn q with its rates w and a.
template <class Turn>
void put_carrying(std::span<double> to, std::size_t at, int lane, const Vec3& u, const Vec3& ud, const Vec3& udd,
                  const Turn& turn) {
  put_numbers(to, at + marked::u, lane, u), put_numbers(to, at + marked::ud, lane, ud);
  put_numbers(to, at + marked::udd, lane, udd), put_numbers(to, at + marked::q, lane, turn.q.coefficients());
  put_numbers(to, at + marked::w, lane, turn.w), put_numbers(to, at + marked::a, lane, turn.a);
}

}  // namespace

Batch::Trees Batch::trees_of(std::span<System* const> systems, Formulation formulation, std::string& why_not) {
  Trees trees;
  for (const System* system : systems) {
    TreeLayout layout = lay_out_tree(*system, system->start().modes, Taken::all);
    why_not = layout.tree ? why_no_lanes(layout, *system) : layout.why_not;
    if (why_not.empty() && formulation != Formulation::joint) why_not = slender_body(*layout.tree, *system);
    if (why_not.empty() && !trees.empty() &&
        !(has_equal_joints(*trees.front().tree, *layout.tree) &&
          are_alike(*systems.front(), trees.front(), *system, layout)))
      why_not = "the joints of two instances are ordered differently";
    if (!why_not.empty()) return {};
    trees.push_back(std::move(layout));
  }
  return trees;
}

void Batch::lay_out(const Trees& trees) {
  TreeClosures::Layouts layouts{};
  for (int l = 0; l < kLanes; ++l) {
    layouts[l] = &trees[l < n_ ? l : 0];
    trees_[l] = layouts[l]->tree;
  }
  data_.plan = make_plan(*trees_[0], plane_of(*layouts[0]));
  for (const TreeLayout* layout : layouts)
    if (plane_of(*layout) != data_.plan.normal) data_.plan.normal = -1;
  axes_ = data_.plan.axes();
  n_q_ = data_.plan.n_q, n_v_ = data_.plan.n_v;
  TreeStore& z = data_.z;
  const TreePlan& plan = data_.plan;
  const std::size_t n = plan.nodes.size();
  const auto size = [&](std::size_t packs) { return arrays_.add(packs); };
  z.gravity = size(3), z.joint = size(joint::size * n), z.more = size(plan.size_more), z.law = size(plan.size_law);
  z.cosine = size(n), z.sine = size(n), z.moving = size(moving::size * (n + 1)), z.largest = size(2);
  z.travel = size(struct_size::travel * n), z.dof = size(struct_size::coordinate * plan.n_v);
  z.waiting = size(struct_size::inertia * plan.n_waiting), z.varied = size(varied::size * (n + 1));
  half_.assign(kL * n, 0.0), start_.assign(kL * end::size * n, 0.0), now_ = start_;
  if (has_forces_) z.wrench = size(6 * n);
  closures_ = std::make_unique<TreeClosures>(systems_, layouts, data_, pass_);
  n_followed_ = 12 * trees_.front()->followed().size();
  node_of_.resize(n);
  for (std::size_t k = 0; k < n; ++k) node_of_[data_.plan.nodes[k].slot] = k;
  fill_joints();
}

void Batch::fill_joints() {
  const TreeStore& z = data_.z;
  const bool flat = data_.plan.normal >= 0;
  for (int l = 0; l < kLanes; ++l) {
    put_axes(z.gravity, 0, l, axes_, system(l).gravity());
    put_number(z.moving, moving::e, l, 1.0);
    put_matrix(z.moving, moving::A, l, Mat3::Identity());
    for (std::size_t k = 0; k < data_.plan.nodes.size(); ++k) {
      const LaneNode& n = data_.plan.nodes[k];
      const TreeNode& t = tree(l).nodes()[k];
      const Slot& slot = system(l).slot(t.slot);
      put_axes(z.joint, n.joint + joint::near, l, axes_, t.near_u),
          put_axes(z.joint, n.joint + joint::far, l, axes_, t.far_u);
      put_axes(z.joint, n.joint + joint::K0, l, axes_, t.K0), put_axes(z.joint, n.joint + joint::K1, l, axes_, t.K1);
      put_axes(z.joint, n.joint + joint::axis, l, axes_, t.axis);
      put_number(z.joint, n.joint + joint::m, l, slot.mass);
      put_number(z.moving, moving::size * (k + 1) + moving::A + 8, l, 1.0);  // in a plane for good
      put_numbers(z.joint, n.joint + joint::J, l, packed(in_order(axes_, slot.J)));
      if (!n.needs_more()) continue;
      const TreeAxes axes = t.axes ? *t.axes : TreeAxes();
      for (std::size_t i = 0; i < 3; ++i) put_axes(z.more, n.more + more::slide + 3 * i, l, axes_, axes.slide[i]);
      put_matrix(z.more, n.more + more::ball, l, axes.ball);
      // In a plane near' q r far'^-1 = (near q near^-1) (near r near^-1) K0, each of which turns about the normal.
      put_axes(z.more, n.more + more::near_q, l, axes_, flat ? Quat() : t.near_q);
      put_axes(z.more, n.more + more::far_q, l, axes_, flat ? conjugate(t.K0) : t.far_q);
      put_axes(z.more, n.more + more::hinge, l, axes_, flat ? Vec3(rotation(t.near_q) * t.hinge) : t.hinge);
    }
    if (flat) put_heights(l);
  }
}

// Of the centres of mass along the normal, where nothing moves: after the laws.
void Batch::put_heights(int lane) {
  const auto at = [&](std::span<double> p, std::size_t i) -> double& { return p[kL * i + lane]; };
  for (std::size_t k = 0; k < data_.plan.nodes.size(); ++k) {
    const LaneNode& n = data_.plan.nodes[k];
    const auto height = [&](std::size_t slot) -> double& {
      return at(data_.z.moving, moving::size * slot + moving::x + 2);
    };
    height(k + 1) = height(static_cast<std::size_t>(n.parent + 1)) + at(data_.z.joint, n.joint + joint::near + 2) -
                    at(data_.z.joint, n.joint + joint::far + 2) +
                    (n.has_law ? at(data_.z.law, n.law + imposed::p + 2) : 0);
  }
}

void Batch::to_batch(int lane, State& state) const {
  State out;
  tree(lane).read_off(state, nullptr, out);
  out.coordinates = trees_[lane];
  state = std::move(out);
}

void Batch::to_slots(int lane, State& state) const { to_slot_coordinates(system(lane), state); }

void Batch::read_motion(int lane, int slot, Motion& O) const {
  const std::size_t at = moving::size * (node_of_[slot] + 1);
  const double* b = data_.z.moving.data() + kL * at + lane;
  const auto number = [&](std::size_t i) { return b[kL * i]; };
  Vec3 w, e;
  for (std::size_t i = 0; i < 3; ++i) {
    const int r = axes_[i];
    O.x[r] = number(moving::x + i), O.v[r] = number(moving::v + i), w[r] = number(moving::w + i);
    e[r] = number(moving::e + 1 + i);
    for (std::size_t j = 0; j < 3; ++j) O.A(r, axes_[j]) = number(moving::A + 3 * i + j);
  }
  O.e = Quat::from(number(moving::e), e);
  O.w = O.A.transpose() * w;
}

// In lanes whose laws fail the numbers are those of before.
void Batch::fill_laws(const double* y, const Numbers8& t) {
  if (data_.plan.size_law == 0) return;
  for (int l = 0; l < kLanes; ++l) {
    inputs(l, y, t[l]);
    for (std::size_t k = 0; k < data_.plan.nodes.size(); ++k)
      if (data_.plan.nodes[k].has_law || data_.plan.nodes[k].moving) guarded(l, [&] { fill_laws_of(k, l, t[l]); });
    if (data_.plan.normal >= 0) put_heights(l);
  }
}

// By the last inputs().
void Batch::fill_laws_of(std::size_t node, int lane, double t) {
  const TreeNode& n = tree(lane).nodes()[node];
  const std::size_t at = data_.plan.nodes[node].law;
  if (n.moving) {
    const JointLaws now = joint_laws_at(n, t, states_[lane]);
    put_carrying(data_.z.law, at + marked::near, lane, now.near.u, now.near.ud, now.near.udd, now.near);
    put_carrying(data_.z.law, at + marked::far, lane, now.far.u, now.far.ud, now.far.udd, now.far);
    put_carrying(data_.z.law, at + marked::lock, lane, now.x.p, now.x.pd, now.x.pdd, now.D);
    return;
  }
  Imposed now;
  laws_at(n, t, states_[lane], now);
  const auto put = [&](std::size_t i, const auto& a) { put_axes(data_.z.law, at + i, lane, axes_, a); };
  put(imposed::p, now.p), put(imposed::pd, now.pd), put(imposed::pdd, now.pdd);
  put(imposed::w, now.w), put(imposed::a, now.a), put(imposed::axis, now.axis);
  put(imposed::q, data_.plan.normal < 0 ? now.q : n.near_q * now.q * conjugate(n.near_q));
}

// Moves all slots.
void Batch::move(const double* y, const Numbers8& t, bool with_positions) {
  data_.z.y = {const_cast<double*>(y), n_numbers()}, data_.z.with_positions = with_positions, lost_ = {};
  fill_laws(y, t);
  passes().half_turns(data_, half_.data());
  passes().outward(data_);
}

void Batch::fill_closures(const double* y, const Numbers8& t) {
  if (!closures_->has_laws() && !closures_->has_own_rows()) return;
  for (int l = 0; l < kLanes; ++l) {
    if (closures_->has_own_rows()) see_motions(l);
    const Inputs in = inputs(l, y, t[l]);
    guarded(l, [&] { closures_->fill(system(l), l, in); });
  }
}

Flags8 Batch::evaluate(const double* y, const Numbers8& t, double* rate) {
  move(y, t, reads_motions_ || n_followed_ > 0 || !closures_->empty());
  fill_wrench(y, t);
  Flags8 failed{};
  if (closures_->empty()) {
    passes().accelerate_tree(data_, rate);
  } else {
    fill_closures(y, t);
    failed = closures_->accelerate(n_, rate);
    if (watches_) closures_->see_pivots();
  }
  state_rates(y, t, rate);
  follow_laws(rate);
  for (int l = 0; l < kLanes; ++l)
    failed[l] = failed[l] || lost_[l] || !std::isfinite(data_.z.largest[l] + data_.z.largest[kL + l]);
  return failed;
}

// Rates of the slots that laws move, after q, v and s.
void Batch::follow_laws(double* rate) const {
  if (n_followed_ == 0) return;
  double* to = rate + kL * (n_q_ + n_v_ + n_s_);
  for (std::size_t k = 0; k < data_.plan.nodes.size(); ++k) {
    if (!data_.plan.nodes[k].has_law && !data_.plan.nodes[k].moving) continue;
    const double* slot = data_.z.moving.data() + kL * moving::size * (k + 1);
    for (const std::size_t part : {moving::v, moving::w, moving::a, moving::al}) {
      std::copy_n(slot + kL * part, 3 * kL, to);
      to += 3 * kL;
    }
  }
}

void Batch::watch_pivots() { watches_ = !closures_->empty() && has_loops(*systems_[0], systems_[0]->start().modes); }

void Batch::take_off_turns(int lane, double* y) const {
  for (const TreeNode& node : tree(lane).nodes())
    if (node.turn == TreeTurn::hinge) shed_turns(y[kL * (node.first_q + node.n_slides) + lane]);
}

void Batch::start_from(const double* y, const Numbers8& t) {
  move(y, t, true);
  see_ends();
  start_ = now_;
}

// The motions that the tree has are those at the ends of steps.
void Batch::see_ends() {
  alignas(64) const Numbers8 still{};
  passes().change(data_, start_.data(), still.data(), now_.data(), sizes_.data());
}

void Batch::accept(int lane) {
  for (std::size_t i = lane; i < start_.size(); i += kL) start_[i] = now_[i];
}

Flags8 Batch::change_to(const double* y, const Numbers8& t, const Numbers8& h, std::array<Change, kLanes>& out) {
  alignas(64) const Numbers8 steps = h;
  move(y, t, true);
  passes().change(data_, start_.data(), steps.data(), now_.data(), sizes_.data());
  read(out);
  return lost_;
}

void Batch::weigh(const double* error, std::array<Change, kLanes>& out) {
  passes().vary(data_, error, sizes_.data());
  read(out);
  const double* slot = error + kL * (n_q_ + n_v_ + n_s_);
  for (std::size_t k = 0; k < n_followed_; k += 12, slot += 12 * kL)
    for (int l = 0; l < kLanes; ++l) {
      const auto squared = [&](std::size_t at) {
        const double *x = slot + kL * at + l, *y = x + kL, *z = y + kL;
        return *x * *x + *y * *y + *z * *z;
      };
      const double x = squared(0), r = squared(3), v = squared(6), w = squared(9);
      out[l].take(x, r, v, w);
      if (!std::isfinite(x + r + v + w)) out[l].x = HUGE_VAL;
    }
}

void Batch::read(std::array<Change, kLanes>& out) const {
  for (int l = 0; l < kLanes; ++l) out[l] = {sizes_[l], sizes_[kL + l], sizes_[2 * kL + l], sizes_[3 * kL + l]};
}

}  // namespace lockstep::lanes
