// ForceCheck: the comparisons of check_force, one function each.
#pragma once

#include <string>

#include "framework/tools/check/lock_bench.h"
#include "framework/tools/check/slope.h"

namespace lockstep {

class ForceCheck {
 public:
  ForceCheck(const System& system, const Force& force, CheckReport& report, const CheckOptions& options);
  void run();

 private:
  bool description();
  bool find_place(Draw&);
  void same_again();
  void other_bodies();
  void balance();
  void tangent();
  void memory();
  void jumps();
  void turns();

  void draw_reactions();
  Reactions reactions() const { return {rows_, {lambda_.data(), static_cast<std::size_t>(lambda_.size())}}; }
  bool reads() const { return lambda_.size() > 0; }
  std::vector<Quantity> quantities() const;
  void apply(const Place&, VecX& f) const;  ///< with react(), where it reads reactions
  double loss(const Place&) const;          ///< dissipation(), and friction_loss() likewise
  double power(const Place&) const;
  /// f.v + dV/dt + dissipation - supply, which is zero; with the error of the difference and the size of its terms.
  struct Balance {
    double rest = 0, error = 0, size = 0;
    bool wrong() const;
  };
  Balance balance_of(const Place&) const;
  void diagnose_balance();
  void compare_column(int slot, int k, const MatX& K, bool velocity);
  bool particle(int slot) const;
  std::span<double> memory_of(VecX& z) const;
  std::string here() const;
  void add(const std::string& key, std::string what, std::string look, double weight = 0);

  const System& system_;
  const Force& force_;
  CheckReport& report_;
  const CheckOptions& options_;
  int n_ = 0;
  double length_ = 1;
  RowTable rows_;  // with multipliers drawn once: what a force that reads reactions is given
  VecX lambda_;
  Place place_;
  VecX f_;
  double quiet_ = 0;
  int state_ = 0;
};

}  // namespace lockstep
