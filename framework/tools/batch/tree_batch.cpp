#include "framework/tools/batch/tree_batch.h"

#include <algorithm>
#include <cmath>

#include <lockstep/body.h>
#include <lockstep/error.h>
#include <lockstep/lock.h>
#include "framework/dynamics/evaluate/slot_coordinates.h"
#include "framework/dynamics/solvers/graph.h"
#include "framework/dynamics/tree/closure_cost.h"
#include "framework/dynamics/tree/moving_markers.h"
#include "framework/dynamics/tree/tree_motion.h"

namespace lockstep::lanes {
namespace {

// What makes joint coordinates the dearer ones in lanes, by a rule on counts beside why_dearer(); "" where they are not. They
// are where the squares of the numbers of rows at a node, summed, are more than 6 for each row of all
// (framework/docs/solvers.md, section 3).
std::string why_dearer_in_lanes(const System& system, const TreeLayout& layout) {
  constexpr double kMostSquares = 6;
  RowTable all;
  system.lay_out(system.start().modes, all);
  if (squares_of(layout.fronts) <= kMostSquares * all.n_rows) return "";
  return "the rows of what closes loops cost more along joints than in omega, in lanes";
}

// Why a tree has no lanes; "" if it has.
std::string why_no_lanes(const TreeLayout& layout, const System& system) {
  if (layout.tree->n_v() == 0) return "laws alone move it, no coordinate is free; take the formulation auto or omega";
  for (const auto& force : system.forces())
    if (system.plane() && !force->stays_in_plane(system.plane()))
      return "force '" + force->name() + "' does not say that it stays in the plane of the system";
  return "";
}

bool has_equal_joints(const JointTree& a, const JointTree& b) {
  return std::ranges::equal(a.nodes(), b.nodes(), [](const TreeNode& x, const TreeNode& y) {
    return x.slot == y.slot && x.parent == y.parent && x.link == y.link && x.n_slides == y.n_slides &&
           x.turn == y.turn && x.reversed == y.reversed && x.rows == y.rows && !x.imposed == !y.imposed &&
           !x.moving == !y.moving;
  });
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

TreeBatch::Trees TreeBatch::trees_of(std::span<System* const> systems, Taken taken, std::string& why_not) {
  Trees trees;
  for (const System* system : systems) {
    TreeLayout layout = lay_out_tree(*system, system->start().modes, taken);
    why_not = layout.tree ? why_no_lanes(layout, *system) : layout.why_not;
    if (why_not.empty() && taken == Taken::where_cheaper) why_not = why_dearer_in_lanes(*system, layout);
    if (why_not.empty() && !trees.empty() &&
        !(has_equal_joints(*trees.front().tree, *layout.tree) &&
          are_alike(*systems.front(), trees.front(), *system, layout)))
      why_not = "the joints of two copies are not laid out alike";
    if (!why_not.empty()) return {};
    trees.push_back(std::move(layout));
  }
  return trees;
}

TreeBatch::TreeBatch(std::span<System* const> systems, int first, const Trees& trees, const CopiesOptions& options)
    : Batch(systems, first, static_cast<std::size_t>(trees.front().tree->n_q()),
            static_cast<std::size_t>(trees.front().tree->n_v()), options),
      stabilization_(options.stabilization),
      plan_(make_plan(*trees.front().tree)) {
  TreeClosures::Layouts layouts{};
  for (std::size_t l = 0; l < kL; ++l) {
    layouts[l] = &trees[l < trees.size() ? l : 0];
    trees_[l] = layouts[l]->tree;
  }
  const std::size_t n = plan_.nodes.size();
  const auto size = [&](std::size_t packs) { return arrays_.add(packs); };
  z_.gravity = size(3), z_.joint = size(joint::size * n), z_.more = size(plan_.size_more),
  z_.law = size(plan_.size_law);
  z_.cosine = size(n), z_.sine = size(n), z_.moving = size(moving::size * (n + 1)), z_.largest = size(2);
  z_.travel = size(travel::size * n), z_.dof = size(dof::size * plan_.n_v);
  z_.waiting = size(articulated::size * plan_.n_waiting), z_.varied = size(varied::size * (n + 1));
  half_.assign(kL * n, 0.0), start_.assign(kL * end::size * n, 0.0), now_ = start_;
  if (has_forces_) z_.wrench = wrench_;
  closures_.begin(systems_, layouts, pass_);
  n_followed_ = 12 * trees_.front()->followed().size();
  node_of_.resize(n);
  for (std::size_t k = 0; k < n; ++k) node_of_[static_cast<std::size_t>(plan_.nodes[k].slot)] = k;
  fill_joints();
}

void TreeBatch::fill_joints() {
  for (int l = 0; l < kLanes; ++l) {
    put_numbers(z_.gravity, 0, l, system(l).gravity());
    put_number(z_.moving, moving::e, l, 1.0);
    put_matrix(z_.moving, moving::A, l, Mat3::Identity());
    for (std::size_t k = 0; k < plan_.nodes.size(); ++k) {
      const LaneNode& n = plan_.nodes[k];
      const TreeNode& t = tree(l).nodes()[k];
      const Slot& slot = system(l).slot(t.slot);
      put_numbers(z_.joint, n.joint + joint::near, l, t.near_u),
          put_numbers(z_.joint, n.joint + joint::far, l, t.far_u);
      put_numbers(z_.joint, n.joint + joint::K0, l, t.K0.coefficients());
      put_numbers(z_.joint, n.joint + joint::K1, l, t.K1.coefficients());
      put_numbers(z_.joint, n.joint + joint::axis, l, t.axis);
      put_number(z_.joint, n.joint + joint::m, l, slot.mass);
      put_numbers(z_.joint, n.joint + joint::J, l, packed(slot.J));
      if (!n.needs_more()) continue;
      const TreeAxes axes = t.axes ? *t.axes : TreeAxes();
      for (std::size_t i = 0; i < 3; ++i) put_numbers(z_.more, n.more + more::slide + 3 * i, l, axes.slide[i]);
      put_matrix(z_.more, n.more + more::ball, l, axes.ball);
      put_numbers(z_.more, n.more + more::near_q, l, t.near_q.coefficients());
      put_numbers(z_.more, n.more + more::far_q, l, t.far_q.coefficients());
      put_numbers(z_.more, n.more + more::hinge, l, t.hinge);
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
  const double* b = z_.moving.data() + kL * at + static_cast<std::size_t>(lane);
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
    for (std::size_t k = 0; k < plan_.nodes.size(); ++k)
      if (plan_.nodes[k].has_law || plan_.nodes[k].moving)
        guarded(l, [&] { fill_laws_of(k, l, t[static_cast<std::size_t>(l)]); });
  }
}

// By the last inputs().
void TreeBatch::fill_laws_of(std::size_t node, int lane, double t) {
  const TreeNode& n = tree(lane).nodes()[node];
  const std::size_t at = plan_.nodes[node].law;
  if (n.moving) {
    const JointLaws now = joint_laws_at(n, t, states_of(lane));
    put_carrying(z_.law, at + marked::near, lane, now.near.u, now.near.ud, now.near.udd, now.near);
    put_carrying(z_.law, at + marked::far, lane, now.far.u, now.far.ud, now.far.udd, now.far);
    put_carrying(z_.law, at + marked::lock, lane, now.x.p, now.x.pd, now.x.pdd, now.D);
    return;
  }
  Imposed now;
  laws_at(n, t, states_of(lane), now);
  put_numbers(z_.law, at + imposed::p, lane, now.p), put_numbers(z_.law, at + imposed::pd, lane, now.pd);
  put_numbers(z_.law, at + imposed::pdd, lane, now.pdd), put_numbers(z_.law, at + imposed::w, lane, now.w);
  put_numbers(z_.law, at + imposed::a, lane, now.a), put_numbers(z_.law, at + imposed::axis, lane, now.axis);
  put_numbers(z_.law, at + imposed::q, lane, now.q.coefficients());
}

// Moves all slots.
void TreeBatch::move(const double* y, const Numbers8& t, bool with_positions) {
  z_.y = {const_cast<double*>(y), n_numbers()}, z_.with_positions = with_positions, lost_ = {};
  fill_laws(y, t);
  passes().half_turns(plan_, z_, half_.data());
  passes().outward(plan_, z_);
}

void TreeBatch::fill_closures(const double* y, const Numbers8& t) {
  if (!closures_.has_laws() && !closures_.has_own_rows()) return;
  for (int l = 0; l < kLanes; ++l) {
    if (closures_.has_own_rows()) see_motions(l);
    const Inputs in = inputs(l, y, t[static_cast<std::size_t>(l)]);
    guarded(l, [&] { closures_.fill(system(l), l, in); });
  }
}

Flags8 TreeBatch::evaluate(const double* y, const Numbers8& t, double* rate) {
  move(y, t, reads_motions_ || n_followed_ > 0 || !closures_.empty());
  fill_wrench(y, t);
  Flags8 failed{};
  if (closures_.empty()) {
    passes().accelerate_tree(plan_, z_, rate);
  } else {
    fill_closures(y, t);
    failed = closures_.accelerate(plan_, z_, n_, rate);
    if (watches_) closures_.see_pivots(plan_, z_);
  }
  state_rates(y, t, rate);
  follow_laws(rate);
  for (std::size_t l = 0; l < kL; ++l)
    failed[l] = failed[l] || lost_[l] || !std::isfinite(z_.largest[l] + z_.largest[kL + l]);
  return failed;
}

// Rates of the slots that laws move, after q, v and s.
void TreeBatch::follow_laws(double* rate) const {
  if (n_followed_ == 0) return;
  double* to = rate + kL * (n_q_ + n_v_ + n_s_);
  for (std::size_t k = 0; k < plan_.nodes.size(); ++k) {
    if (!plan_.nodes[k].has_law && !plan_.nodes[k].moving) continue;
    const double* slot = z_.moving.data() + kL * moving::size * (k + 1);
    for (const std::size_t part : {moving::v, moving::w, moving::a, moving::al}) {
      std::copy_n(slot + kL * part, 3 * kL, to);
      to += 3 * kL;
    }
  }
}

void TreeBatch::watch_pivots() { watches_ = !closures_.empty() && has_loops(*systems_[0], systems_[0]->start().modes); }

void TreeBatch::take_off_turns(int lane, double* y) const {
  for (const TreeNode& node : tree(lane).nodes())
    if (node.turn == TreeTurn::hinge)
      shed_turns(y[kL * static_cast<std::size_t>(node.first_q + node.n_slides) + static_cast<std::size_t>(lane)]);
}

double TreeBatch::largest_a(std::size_t lane) const { return std::sqrt(z_.largest[lane]); }
double TreeBatch::largest_alpha(std::size_t lane) const { return std::sqrt(z_.largest[kL + lane]); }

void TreeBatch::start_from(const double* y, const Numbers8& t) {
  move(y, t, true);
  see_ends();
  start_ = now_;
}

// The motions that the tree has are those at the ends of steps.
void TreeBatch::see_ends() {
  alignas(64) const Numbers8 still{};
  passes().change(plan_, z_, start_.data(), still.data(), now_.data(), sizes_.data());
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
  const double* slot = error + kL * (n_q_ + n_v_ + n_s_);
  for (std::size_t k = 0; k < n_followed_; k += 12, slot += 12 * kL)
    for (std::size_t l = 0; l < kL; ++l) {
      const auto squared = [&](std::size_t at) {
        const double *x = slot + kL * at + l, *y = x + kL, *z = y + kL;
        return *x * *x + *y * *y + *z * *z;
      };
      const double x = squared(0), r = squared(3), v = squared(6), w = squared(9);
      out[l].take(x, r, v, w);
      if (!std::isfinite(x + r + v + w)) out[l].x = HUGE_VAL;
    }
}

void TreeBatch::read(std::array<Change, kLanes>& out) const {
  for (std::size_t l = 0; l < kL; ++l) out[l] = {sizes_[l], sizes_[kL + l], sizes_[2 * kL + l], sizes_[3 * kL + l]};
}

}  // namespace lockstep::lanes
