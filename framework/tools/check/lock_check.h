// SPDX-License-Identifier: BSD-3-Clause
// LockCheck: the comparisons of check_lock. Those of derivatives are in lock_derivatives.cpp, the others in
// check_lock.cpp.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "framework/tools/check/lock_bench.h"
#include "framework/tools/check/state_check.h"

namespace lockstep {

class LockCheck final : public StateCheck {
 public:
  /// `sibling`: another link of the type, to form a group; null: the link is twice in the group.
  LockCheck(const System&, const Lock&, const Lock* sibling, CheckReport&, const CheckOptions&);

 private:
  MatX numbers(const TestState& at) override { return rows_of(system_, link_, at); }
  std::string name(Eigen::Index row, Eigen::Index column) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  std::string why_not_finite() const override;
  bool description() override;
  void at_state() override;
  void turns() override;

  void everything_written();
  void group();
  void pose_alone();  ///< C, Ct and the jacobian do not depend on velocities
  void jacobian();
  void time_derivatives();
  void tangent();

  std::string row(int k) const { return "row " + link_.row_name(k); }
  auto J(int k, int slot) const { return is_.block<1, 6>(k, 3 + 6 * slot); }
  std::string jacobian_hint(int k, int slot, bool turn, const Vec3& should_be) const;
  Slope minus_Cdd(const TestState&) const;
  std::string diagnose_right_side(int k);

  const Lock& link_;
  const Lock* sibling_;
  int m_;  // rows
};

}  // namespace lockstep
