#include "framework/tools/batch/tree_batch.h"

#include <algorithm>
#include <cmath>

#include <lockstep/body.h>
#include <lockstep/error.h>
#include <lockstep/lock.h>
#include "framework/dynamics/evaluate/slot_coordinates.h"
#include "framework/dynamics/tree/tree_motion.h"

namespace lockstep::lanes {
namespace {

// Why a tree has no lanes; "" if it has.
std::string why_no_lanes(const JointTree& tree, const System& system) {
  const auto link = [&](int number) {
    return "link '" + system.links()[static_cast<std::size_t>(number)]->name() + "' ";
  };
  if (!tree.closures().empty()) return link(tree.closures().front()) + "closes a loop";
  if (tree.n_v() == 0) return "no coordinate is free";
  for (const TreeNode& n : tree.nodes()) {
    if (n.left != 0) return link(n.link) + "has rows that its joint does not hold";
    if (n.moving) return link(n.link) + "has a marker that moves on its body";
  }
  for (const auto& force : system.forces())
    if (system.plane() && !force->stays_in_plane(system.plane()))
      return "force '" + force->name() + "' does not say that it stays in the plane of the system";
  return "";
}

bool are_alike(const JointTree& a, const JointTree& b) {
  return std::ranges::equal(a.nodes(), b.nodes(), [](const TreeNode& x, const TreeNode& y) {
    return x.slot == y.slot && x.parent == y.parent && x.link == y.link && x.n_slides == y.n_slides &&
           x.turn == y.turn && x.reversed == y.reversed && !x.imposed == !y.imposed;
  });
}

// xx xy xz yy yz zz
Eigen::Matrix<double, 6, 1> packed(const Mat3& J) { return {J(0, 0), J(0, 1), J(0, 2), J(1, 1), J(1, 2), J(2, 2)}; }

}  // namespace

TreeBatch::Trees TreeBatch::trees_of(std::span<System* const> systems, std::string& why_not) {
  Trees trees;
  for (const System* system : systems) {
    auto tree = JointTree::of(*system, system->start().modes, why_not);
    if (tree) why_not = why_no_lanes(*tree, *system);
    if (why_not.empty() && !trees.empty() && !are_alike(*trees.front(), *tree))
      why_not = "the joints of two copies are not laid out alike";
    if (!why_not.empty()) return {};
    trees.push_back(std::move(tree));
  }
  return trees;
}

TreeBatch::TreeBatch(std::span<System* const> systems, int first, Trees trees, const CopiesOptions& options)
    : Batch(systems, first, static_cast<std::size_t>(trees.front()->n_q()),
            static_cast<std::size_t>(trees.front()->n_v()), options),
      trees_(std::move(trees)),
      plan_(make_plan(*trees_.front())) {
  while (trees_.size() < kL) trees_.push_back(trees_.front());
  const std::size_t n = plan_.nodes.size();
  const auto size = [](Aligned<double>& v, std::size_t packs) {
    return v.assign(kL * std::max<std::size_t>(packs, 1), 0.0), v.data();
  };
  z_.gravity = size(gravity_, 3), z_.joint = size(joint_, joint::size * n), z_.more = size(more_, plan_.size_more);
  z_.law = size(law_, plan_.size_law), z_.half = size(half_, n), z_.cosine = size(cosine_, n), z_.sine = size(sine_, n);
  z_.moving = size(moving_, moving::size * (n + 1)), z_.dof = size(dof_, dof::size * plan_.n_v);
  z_.waiting = size(waiting_, articulated::size * plan_.n_waiting), z_.largest = size(largest_, 2);
  z_.varied = size(varied_, varied::size * (n + 1)), size(start_, end::size * n), size(now_, end::size * n);
  if (has_forces_) z_.wrench = wrench_.data();
  node_of_.resize(n);
  for (std::size_t k = 0; k < n; ++k) node_of_[static_cast<std::size_t>(plan_.nodes[k].slot)] = k;
  fill_joints();
}

void TreeBatch::fill_joints() {
  for (int l = 0; l < kLanes; ++l) {
    put_numbers(gravity_, 0, l, system(l).gravity());
    put_number(moving_, moving::e, l, 1.0);
    put_matrix(moving_, moving::A, l, Mat3::Identity());
    for (std::size_t k = 0; k < plan_.nodes.size(); ++k) {
      const LaneNode& n = plan_.nodes[k];
      const TreeNode& t = tree(l).nodes()[k];
      const Slot& slot = system(l).slot(t.slot);
      put_numbers(joint_, n.joint + joint::near, l, t.near_u), put_numbers(joint_, n.joint + joint::far, l, t.far_u);
      put_numbers(joint_, n.joint + joint::K0, l, t.K0.coefficients());
      put_numbers(joint_, n.joint + joint::K1, l, t.K1.coefficients());
      put_numbers(joint_, n.joint + joint::axis, l, t.axis);
      put_number(joint_, n.joint + joint::m, l, slot.mass);
      put_numbers(joint_, n.joint + joint::J, l, packed(slot.J));
      if (n.n_slides == 0 && n.turn != TreeTurn::ball && !n.has_law) continue;
      for (std::size_t i = 0; i < 3; ++i) put_numbers(more_, n.more + more::slide + 3 * i, l, t.slide[i]);
      put_matrix(more_, n.more + more::ball, l, t.ball);
      put_numbers(more_, n.more + more::near_q, l, t.near_q.coefficients());
      put_numbers(more_, n.more + more::far_q, l, t.far_q.coefficients());
      put_numbers(more_, n.more + more::hinge, l, t.hinge);
    }
  }
}

void TreeBatch::to_batch(int lane, State& state) const {
  State out;
  tree(lane).read_off(state, nullptr, out);
  out.coordinates = trees_[static_cast<std::size_t>(lane)];
  state = std::move(out);
}

void TreeBatch::to_slots(int lane, State& state) const { to_slot_coordinates(system(lane), state); }

void TreeBatch::read_motion(int lane, int slot, Motion& O) const {
  const std::size_t at = moving::size * (node_of_[static_cast<std::size_t>(slot)] + 1);
  const double* b = moving_.data() + kL * at + static_cast<std::size_t>(lane);
  const auto number = [&](std::size_t i) { return b[kL * i]; };
  Vec3 w;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto r = static_cast<Eigen::Index>(i);
    O.x[r] = number(moving::x + i), O.v[r] = number(moving::v + i), w[r] = number(moving::w + i);
    for (std::size_t j = 0; j < 3; ++j) O.A(r, static_cast<Eigen::Index>(j)) = number(moving::A + 3 * i + j);
  }
  O.e = {number(moving::e), number(moving::e + 1), number(moving::e + 2), number(moving::e + 3)};
  O.w = O.A.transpose() * w;
}

// In lanes whose laws fail the numbers are those of before.
void TreeBatch::fill_laws(const double* y, const Numbers8& t) {
  if (plan_.size_law == 0) return;
  for (int l = 0; l < kLanes; ++l) {
    inputs(l, y, t[static_cast<std::size_t>(l)]);
    for (std::size_t k = 0; k < plan_.nodes.size(); ++k) {
      const LaneNode& n = plan_.nodes[k];
      if (!n.has_law) continue;
      guarded(l, [&] {
        Imposed now;
        laws_at(tree(l).nodes()[k], t[static_cast<std::size_t>(l)], states_of(l), now);
        put_numbers(law_, n.law + imposed::p, l, now.p), put_numbers(law_, n.law + imposed::pd, l, now.pd);
        put_numbers(law_, n.law + imposed::pdd, l, now.pdd), put_numbers(law_, n.law + imposed::w, l, now.w);
        put_numbers(law_, n.law + imposed::a, l, now.a), put_numbers(law_, n.law + imposed::axis, l, now.axis);
        put_numbers(law_, n.law + imposed::q, l, now.q.coefficients());
      });
    }
  }
}

// Moves all slots.
void TreeBatch::move(const double* y, const Numbers8& t, bool with_positions) {
  z_.y = y, z_.with_positions = with_positions, lost_ = {};
  fill_laws(y, t);
  passes().half_turns(plan_, z_);
  passes().outward(plan_, z_);
}

Flags8 TreeBatch::evaluate(const double* y, const Numbers8& t, double* rate) {
  move(y, t, reads_motions_);
  fill_wrench(y, t);
  passes().accelerate_tree(plan_, z_, rate);
  state_rates(y, t, rate);
  Flags8 failed = lost_;
  for (std::size_t l = 0; l < kL; ++l) failed[l] = failed[l] || !std::isfinite(largest_[l] + largest_[kL + l]);
  return failed;
}

double TreeBatch::largest_a(std::size_t lane) const { return std::sqrt(largest_[lane]); }
double TreeBatch::largest_alpha(std::size_t lane) const { return std::sqrt(largest_[kL + lane]); }

void TreeBatch::start_from(const double* y, const Numbers8& t) {
  alignas(64) const Numbers8 still{};
  move(y, t, true);
  passes().change(plan_, z_, start_.data(), still.data(), now_.data(), sizes_.data());
  start_ = now_;
}

void TreeBatch::accept(int lane) {
  for (std::size_t i = static_cast<std::size_t>(lane); i < start_.size(); i += kL) start_[i] = now_[i];
}

Flags8 TreeBatch::change_to(const double* y, const Numbers8& t, const Numbers8& h, std::array<Change, kLanes>& out) {
  alignas(64) const Numbers8 steps = h;
  move(y, t, true);
  passes().change(plan_, z_, start_.data(), steps.data(), now_.data(), sizes_.data());
  read(out);
  return lost_;
}

void TreeBatch::weigh(const double* error, std::array<Change, kLanes>& out) {
  passes().vary(plan_, z_, error, sizes_.data());
  read(out);
}

void TreeBatch::read(std::array<Change, kLanes>& out) const {
  for (std::size_t l = 0; l < kL; ++l) out[l] = {sizes_[l], sizes_[kL + l], sizes_[2 * kL + l], sizes_[3 * kL + l]};
}

// Nothing drifts; the quaternions of balls are scaled to length one.
void TreeBatch::project(double* y, const Numbers8&, const Flags8&, std::array<Landing, kLanes>& landed) {
  landed.fill({});
  for (const LaneNode& n : plan_.nodes) {
    if (n.turn != TreeTurn::ball) continue;
    for (std::size_t l = 0; l < kL; ++l) {
      double* e = y + kL * (n.q + static_cast<std::size_t>(n.n_slides)) + l;
      const double unit = 1.0 / std::sqrt(e[0] * e[0] + e[kL] * e[kL] + e[2 * kL] * e[2 * kL] + e[3 * kL] * e[3 * kL]);
      for (std::size_t i = 0; i < 4; ++i) e[kL * i] *= unit;
    }
  }
}

}  // namespace lockstep::lanes
