// LockCheck: the comparisons of check_lock, one function each.
#pragma once

#include <string>

#include "framework/tools/check/lock_bench.h"
#include "framework/tools/check/slope.h"

namespace lockstep {

class LockCheck {
 public:
  /// `sibling`: another link of the type, for groups; null: the link stands twice in the group.
  LockCheck(const System& system, const Lock& link, const Lock* sibling, CheckReport& report,
            const CheckOptions& options);
  void run();

 private:
  // -- once
  bool description();
  void turns();
  void jumps();
  // -- at each state
  bool find_place(Draw&);
  void everything_written();
  void same_again();
  void other_sign();
  void jacobian();
  void time_derivative();
  void right_side();
  // velocities may enter Qhat alone
  void velocities_leave_alone();
  void tangent();
  void memory();
  void accept_step(const Place& at, VecX& z) const;

  std::string row(int k) const;
  std::string here() const;  ///< "(seed 7, state 3)"
  void add(const std::string& key, std::string what, std::string look, double weight = 0);
  bool compare(double is, double should_be, double error, double size);
  std::string jacobian_hint(int k, int slot, bool turn, const Vec3& should_be) const;
  Slope minus_Cdd(const Place&, double reach);
  std::string diagnose_right_side(int k);
  void turn_about_z(const Marker& p, const Marker& s);

  const System& system_;
  const Lock& link_;
  const Lock* sibling_;
  CheckReport& report_;
  const CheckOptions& options_;
  LockBench bench_;
  int m_ = 0, n_ = 0;  // rows, slots of the system
  double length_ = 1;  // m, what moves are small against
  Place place_;        // the state looked at
  LockRows rows_;      // there
  double quiet_ = 0;   // no law jumps within this time about it
  int state_ = 0;
};

}  // namespace lockstep
