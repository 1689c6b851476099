// TreeClosures: the rows that close the loops of a batch in joint coordinates: their arrays, and the rule by which each
// lane is corrected. Private to the room.
#pragma once

#include "framework/tools/batch/batch.h"

namespace lockstep::lanes {

class TreeClosures {
 public:
  using Systems = std::array<System*, kLanes>;
  using Layouts = std::array<const TreeLayout*, kLanes>;
  /// Of systems whose layouts are alike; nothing where these have no rows.
  void begin(const Systems&, const Layouts&, const Passes&);

  const ClosurePlan& plan() const { return plan_; }
  const ClosureStore& numbers() const { return z_; }
  bool empty() const { return plan_.empty(); }
  bool has_laws() const { return has_laws_; }
  /// Whether links write rows of their own, which needs the motions of the copies.
  bool has_own_rows() const { return !plan_.own.empty(); }
  /// Sets the laws of the links of one copy, and the rows that they write. Throws what they throw.
  void fill(const System&, int lane, const Inputs&);

  /// Accelerations at the motions that the tree has; true in the lanes whose rows are not met. The first n are looked at.
  Flags8 accelerate(const TreePlan&, const TreeStore&, int n, double* rate);
  /// Of the last of them: how many pivots are small, and the smallest of the others, relative to its diagonal.
  void see_pivots(const TreePlan&, const TreeStore&);
  double n_small(std::size_t lane) const { return pivots_[lane]; }
  double smallest_pivot(std::size_t lane) const { return pivots_[kL + lane]; }

  /// C and Cd = J v + Ct at the motions that the tree has; the second alone after new velocities.
  void gather(const TreePlan& tree, const TreeStore& z) { pass_->closure_errors(tree, z, plan_, z_); }
  void gather_rates(const TreePlan& tree, const TreeStore& z) { pass_->closure_rates(tree, z, plan_, z_); }
  /// Their largest numbers, as Evaluation::norm measures them.
  Numbers8 norm_C(const TreePlan& tree, const TreeStore& z) { return norm(tree, z, z_.rows.C); }
  Numbers8 norm_Cd(const TreePlan& tree, const TreeStore& z) { return norm(tree, z, z_.Cd); }
  /// The elimination of the rows as gathered last.
  void factor(const TreePlan& tree, const TreeStore& z) { pass_->factor_closures(tree, z, plan_, z_); }
  /// The change of the velocities of least kinetic energy by which C or Cd vanish in the wanted lanes; none in others.
  const double* correct_C(const TreePlan& tree, const TreeStore& z, const Flags8& wanted) {
    return correct(tree, z, z_.rows.C, wanted);
  }
  const double* correct_Cd(const TreePlan& tree, const TreeStore& z, const Flags8& wanted) {
    return correct(tree, z, z_.Cd, wanted);
  }

 private:
  void fill_own_rows(const System&, int lane, const Inputs&);
  void fill_inverses(const Systems&, const Layouts&);
  void measure_floors();
  // Residuals of rows, relative to their scales: the largest, and that of rows that are not redundant.
  struct Residuals {
    Numbers8 all, regular;
    bool met(std::size_t lane) const;
  };
  Residuals residuals(const TreePlan&, const TreeStore&);
  Numbers8 norm(const TreePlan&, const TreeStore&, std::span<const double>);
  const double* correct(const TreePlan&, const TreeStore&, std::span<const double> r, const Flags8& wanted);

  ClosurePlan plan_;
  ClosureStore z_{};
  RowTable scratch_;  // of one link
  const Passes* pass_ = nullptr;
  bool has_laws_ = false, floors_known_ = false;
  Arrays arrays_;  // of z_
  Aligned<double> masked_, dv_, length_;
  alignas(64) std::array<double, 2 * kLanes> pivots_{};        // n_small, smallest_pivot
  alignas(64) std::array<double, 3 * kLanes> pivot_floors_{};  // one pack per RowKind
};

}  // namespace lockstep::lanes
