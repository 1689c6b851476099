// SPDX-License-Identifier: BSD-3-Clause
// RecursionIn: the recursion on a tree, one text for all spaces and numbers. A file that is compiled for several
// instruction sets instantiates it.
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <lockstep/detail/rows.h>
#include "framework/dynamics/tree/closure_rows.h"
#include "framework/dynamics/tree/inward_places.h"
#include "framework/dynamics/tree/joint_passes.h"
#include "framework/dynamics/tree/open_rows.h"
#include "framework/dynamics/tree/tree_recursion.h"
#include "framework/foundation/support/clones.h"

namespace lockstep {

/// The rows of links that are not in the tree: read, eliminated along with the recursion, and measured. What depends on
/// the space, the Slots of the recursion do:
///
///     read_side(view, i, k, node, motion, diagonal)  Jacobian of row k on the i-th slot; adds J M^-1 J' to diagonal
///     move_to_joint(node, K)                         from the centre of mass to the node's point; returns what l gains
///     centre(node)                                   acceleration of the centre of mass
template <class Space>
class LoopClosures final : public ClosureRows {
 public:
  using Wrench = typename Space::Wrench;
  using Twist = typename Space::Twist;

  /// Sizes everything for this tree and the rows of its closures.
  void begin(const JointTree& tree, const System& system, ClosureFronts fronts) {
    const auto mass = [&](const TreeNode& n) { return system.slot(n.slot).mass; };
    const auto [lightest, heaviest] = std::ranges::minmax_element(tree.nodes(), {}, mass);
    ClosureRows::begin(std::move(fronts), system.length(), mass(*heaviest) / mass(*lightest));
    K_.assign(fronts_.rows.size(), {}), J_.assign(fronts_.sides.size(), {});
    wrenches_.assign(fronts_.n_nodes, {}), changes_.assign(fronts_.n_nodes, {});
    du_.setZero(tree.n_v());
    order_.row_at = fronts_.rows, order_.ended_at.assign(fronts_.sources.size(), 0);
  }

  /// Reads the rows, gathered at these motions; their right-hand sides c are Qhat. After the outward pass.
  template <class Slots>
  LOCKSTEP_INLINE void read(const Slots& slots, std::span<const Motion> motions, const RowTable& table) {
    pivots_ = redundant() != 0;
    OpenRows<Space> open = rows();
    open.clear();
    diagonal_.setZero();
    for (const RowEntry& e : table.entries) {
      const RowView block = table.block(e);
      for (int k = 0; k < e.m; ++k) {
        const int row = e.first_row + k;
        c_[row] = block.Qhat(k);
        const ClosureSource& source = fronts_.sources[row];
        double l = -c_[row];
        for (int i = 0; i < source.n_sides; ++i) {
          const auto at = static_cast<std::size_t>(source.first_side + i);
          const ClosureSide& side = fronts_.sides[at];
          const auto node = static_cast<std::size_t>(side.node);
          const Motion& motion = motions[e.slots[i] + 1];
          Wrench& J = J_[at];
          J = slots.read_side(block, i, k, node, motion, diagonal_[row]);
          Wrench K = J;
          l += slots.move_to_joint(node, K);
          K_[side.place] += K;
        }
        open.l_of(static_cast<std::size_t>(row)) = l;
      }
    }
    measure_scales(table);
  }

  /// After the recursion, or a correction: measures J a - c, and returns whether it is small enough.
  template <class Slots>
  LOCKSTEP_INLINE bool met(const Slots& slots, bool corrected) {
    for (const bool raised : {false, true}) {
      for (std::size_t j = 0; j < fronts_.sources.size(); ++j) {
        const ClosureSource& source = fronts_.sources[j];
        const auto row = static_cast<Eigen::Index>(j);
        const auto side = [&](std::size_t at, auto&& take) __attribute__((always_inline)) {
          take(J_[at], slots.centre(static_cast<std::size_t>(fronts_.sides[at].node)));
        };
        measure_row(source, raised, c_[row], r_[row], size_[row], side);
      }
      if (is_met(corrected)) return true;
    }
    return false;
  }

  const VecX& measured() const { return r_; }     ///< the residuals that met() has measured
  void add_correction() { lambda_ += dlambda_; }  ///< of them, as found last
  /// What the last correction changes, by node.
  const Twist* changes() const { return changes_.data(); }

  /// For the recursion; afterwards closed() takes what it has counted.
  LOCKSTEP_INLINE OpenRows<Space> rows() {
    return {fronts_,
            K_.data(),
            l_.data(),
            Lambda_.data(),
            V_.data(),
            scale_.data(),
            d_.data(),
            lambda_.data(),
            dlambda_.data(),
            du_.data(),
            wrenches_.data(),
            changes_.data(),
            pivots_ ? &order_ : nullptr};
  }
  LOCKSTEP_INLINE void closed(const OpenRows<Space>& rows) { n_small_ = static_cast<int>(rows.n_small); }

 private:
  std::vector<Wrench> K_,       // by place
      J_,                       // by side, of the slot's centre of mass
      wrenches_;                // of a correction, by node
  std::vector<Twist> changes_;  // likewise
  PivotOrder order_;
  bool pivots_ = false;  // of the rows as read last
};

/// Slots are the nodes of a tree in a Space (spaces.h), parents before their children:
///
///     size(), parent(k), place(k), first_v(k)   the tree; where nodes pass on (InwardPlace)
///     with_joint(k, f)                          calls f with the passes through the joint (joint_passes.h)
///     put(k, found)                             leaves that of the node's point, returns that of the centre of mass
///     found(k)                                  what was left
///     Largest                                   add(a^2, al^2) keeps the largest of both
///
/// From the leaves to the roots, IA = I + sum over children of (IA - U D^-1 U'), and p likewise. add_slot(k, IA): adds the
/// inertia I of a slot alone, and what acts on it; waiting: one for each of the places, zero before and after.
template <class Slots, class Rows, class Waiting, class AddSlot>
LOCKSTEP_INLINE void inward(Slots& slots, Rows& rows, Waiting& waiting, AddSlot&& add_slot) {
  using Inertia = typename Slots::Space::Inertia;
  Inertia IA{};
  bool from_next = false;
  for (std::size_t k = slots.size(); k-- > 0;) {
    const InwardPlace& place = slots.place(k);
    if (!from_next) IA = Inertia{};
    if (place.own >= 0) {
      Inertia& here = waiting[place.own];
      IA.add(here), here = Inertia{};
    }
    add_slot(k, IA);
    rows.close(k, IA);
    slots.with_joint(
        k, [&](const auto& joint) __attribute__((always_inline)) {
          joint.eliminate(IA, place.to == -1);
          rows.pass_on(k, joint);
          if (place.to != -1) joint.shift(IA);
        });
    from_next = place.to == InwardPlace::kNext;
    if (place.to >= 0) waiting[place.to].add(IA);
  }
  rows.close_at_ground();
}

template <class Largest, class Twist>
LOCKSTEP_INLINE void see_largest(Largest& most, const Twist& of) {
  const auto [a2, al2] = squares(of);
  most.add(a2, al2);
}

/// Adds changes of the accelerations, by node; returns the largest as they are then.
template <class Slots, class Twist>
LOCKSTEP_INLINE typename Slots::Largest add_changes(Slots& slots, const Twist* changes) {
  typename Slots::Largest most;
  for (std::size_t k = 0; k < slots.size(); ++k) {
    Twist own = slots.found(k);
    see_largest(most, slots.put(k, own += changes[k]));
  }
  return most;
}

/// From the roots to the leaves: writes the accelerations of the coordinates, and leaves those of the slots, the largest of
/// which it returns.
template <class Slots, class Rows, class Numbers>
LOCKSTEP_INLINE typename Slots::Largest outward(Slots& slots, Rows& rows, Numbers vd) {
  typename Slots::Largest most;
  typename Slots::Space::Twist last{};
  for (std::size_t k = 0; k < slots.size(); ++k) {
    const int parent = slots.parent(k);
    if (parent < 0)
      last = {};
    else if (static_cast<std::size_t>(parent) + 1 != k)
      last = slots.found(static_cast<std::size_t>(parent));
    slots.with_joint(
        k, [&](const auto& joint) __attribute__((always_inline)) {
          last = joint.solve(last, rows.less(k, joint.n_v()), vd + slots.first_v(k));
        });
    see_largest(most, slots.put(k, last));
    rows.find(k, last);
  }
  return most;
}

/// Slots, besides:
///
///     Slots(tree, system, has_closures)
///     outward(y, motions)                       as TreeRecursion has it
///     add_slot(k, motions, f, IA)               as above; asks ahead for what it will read
///     n_waiting()                               places
///     read(k, motions, a), write(k, motions, a) the acceleration of the slot from and to 6 numbers a slot
///     and what LoopClosures asks
template <class Slots>
class RecursionIn final : public TreeRecursion {
 public:
  using Space = typename Slots::Space;
  using Twist = typename Space::Twist;

  RecursionIn(std::shared_ptr<const JointTree> tree, const System& system, ClosureFronts closures)
      : tree_(std::move(tree)), slots_(*tree_, system, !closures.sources.empty()) {
    waiting_.resize(slots_.n_waiting());
    if (closures.sources.empty()) return;
    closures_.begin(*tree_, system, std::move(closures));
    correction_.setZero(tree_->n_v());
  }
  void outward(const State& y, std::vector<Motion>& motions) override { move(y, motions); }
  void read(std::span<const Motion> motions, const RowTable& rows) override { read_rows(motions, rows); }
  void accelerate(std::span<const Motion> motions, const VecX& f, VecX& vd) override {
    vd.resize(tree_->n_v());
    closures_.empty() ? pass(motions, f, vd) : pass_closed(motions, f, vd);
  }
  void follow() override {
    largest_ = {};
    for (std::size_t k = 0; k < slots_.size(); ++k)
      slots_.with_joint(k,
                        [&](const auto& joint) { see_largest(largest_, slots_.put(k, joint.carried(of_parent(k)))); });
  }
  bool met(bool corrected) override { return measure(corrected); }
  void correct(VecX& vd) override {
    find_change(closures_.measured(), correction_);
    closures_.add_correction();
    vd += correction_;
    largest_ = add_changes(slots_, closures_.changes());
  }
  void correct(const VecX& r, VecX& dv) override { find_change(r, dv); }
  void read_off(std::span<const Motion> motions, const VecX& a, VecX& vd) override {
    vd.resize(tree_->n_v());
    largest_ = {};
    for (std::size_t k = 0; k < slots_.size(); ++k) {
      const Twist own = slots_.read(k, motions, a);
      see_largest(largest_, slots_.put(k, own));
      slots_.with_joint(k, [&](const auto& joint) {
        Twist beyond = own;
        beyond -= joint.carried(of_parent(k));
        joint.read_off(tree_->nodes()[k].n_slides, beyond, vd.data() + slots_.first_v(k));
      });
    }
  }
  void accelerations(std::span<const Motion> motions, VecX& a) const override {
    a.resize(6 * tree_->n_slots());
    for (std::size_t k = 0; k < slots_.size(); ++k) slots_.write(k, motions, a);
  }
  ClosureRows& closures() override { return closures_; }
  Largest largest() const override { return largest_; }

 private:
  Twist of_parent(std::size_t k) {
    const int parent = slots_.parent(k);
    return parent < 0 ? Twist{} : slots_.found(static_cast<std::size_t>(parent));
  }
  // What is compiled for several instruction sets, which a virtual function cannot be.
  LOCKSTEP_FLAT_CLONES void move(const State& y, std::vector<Motion>& motions) { slots_.outward(y, motions); }
  LOCKSTEP_FLAT_CLONES void read_rows(std::span<const Motion> motions, const RowTable& rows) {
    closures_.read(slots_, motions, rows);
  }
  LOCKSTEP_FLAT_CLONES void pass(std::span<const Motion> motions, const VecX& f, VecX& vd) {
    NoRows none;
    pass_with(motions, f, none, vd);
  }
  LOCKSTEP_FLAT_CLONES void pass_closed(std::span<const Motion> motions, const VecX& f, VecX& vd) {
    OpenRows<Space> rows = closures_.rows();
    pass_with(motions, f, rows, vd);
    closures_.closed(rows);
  }
  template <class Rows>
  LOCKSTEP_INLINE void pass_with(std::span<const Motion> motions, const VecX& f, Rows& rows, VecX& vd) {
    lockstep::inward(
        slots_, rows, waiting_, [&](std::size_t k, typename Space::Inertia & IA) __attribute__((always_inline)) {
          slots_.add_slot(k, motions, f, IA);
        });
    largest_ = lockstep::outward(slots_, rows, vd.data());
  }
  LOCKSTEP_FLAT_CLONES bool measure(bool corrected) { return closures_.met(slots_, corrected); }
  LOCKSTEP_FLAT_CLONES void find_change(const VecX& r, VecX& dv) {
    dv.resize(tree_->n_v());
    closures_.rows().correct(slots_, r.data(), dv.data());
  }

  std::shared_ptr<const JointTree> tree_;
  Slots slots_;
  std::vector<typename Space::Inertia> waiting_;
  LoopClosures<Space> closures_;
  VecX correction_;
  Largest largest_;
};

}  // namespace lockstep
