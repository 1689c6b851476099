// LockBench: evaluates the rows of one link of a system at inputs that a check varies.
#pragma once

#include <utility>

#include <lockstep/system.h>
#include "framework/tools/check/state_check.h"

namespace lockstep {

class LockBench {
 public:
  LockBench(const System& system, const Lock& link) : system_(system), link_(link) {}

  /// Gathers the link alone; its storage holds `before` when it begins to write. A row has C, Ct, Qhat, and the jacobian
  /// with 6 columns per slot of the system.
  MatX rows(const TestState&, double before = 0) const;
  /// Gathers the link and another of its pattern as one group.
  std::pair<MatX, MatX> rows_of_group(const TestState&, const Lock& other) const;
  /// Whether the last gather wrote outside of its rows.
  bool wrote_outside() const { return wrote_outside_; }
  /// `sign` times C over time, along the motion without accelerations; the link's own states go on by their rates.
  Curve C_along(TestState from, double sign) const;

 private:
  std::vector<MatX> gather(const TestState&, Group, double before) const;
  void move_states(const TestState& from, TestState& to) const;

  const System& system_;
  const Lock& link_;
  mutable bool wrote_outside_ = false;
};

}  // namespace lockstep
