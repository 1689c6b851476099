// LockCheck: the comparisons of check_lock. Those of derivatives are in lock_derivatives.cpp, the others in
// check_lock.cpp.
#pragma once

#include <string>
#include <vector>

#include "framework/tools/check/lock_bench.h"
#include "framework/tools/check/state_check.h"

namespace lockstep {

class LockCheck : private StateCheck {
 public:
  /// `sibling`: another link of the type, to form a group; null: the link is twice in the group.
  LockCheck(const System&, const Lock&, const Lock* sibling, CheckReport&, const CheckOptions&);
  void run();

 private:
  // -- once
  bool description();
  void jumps();
  void turn_about_z(const Marker& p, const Marker& s);
  // -- at each state
  bool find_state(Draw&);
  void everything_written();
  void same_again();
  void other_sign();
  void pose_alone();  ///< C, Ct and the jacobian do not depend on velocities
  void memory();
  void jacobian();
  void time_derivative();
  void right_side();
  void tangent();

  std::string row(int k) const { return "row " + link_.row_name(k); }
  std::string part(int part, int k) const { return std::string(kPartName[part]) + " of " + row(k); }
  bool compare(double is, double should_be, double error, double size);
  std::string jacobian_hint(int k, int slot, bool turn, const Vec3& should_be) const;
  Slope minus_Cdd(const TestState&);
  std::string diagnose_right_side(int k);

  const Lock& link_;
  const Lock* sibling_;
  LockBench bench_;
  int m_;                   // rows
  std::vector<int> slots_;  // of the link
  LockRows rows_;           // at the state under test
};

}  // namespace lockstep
