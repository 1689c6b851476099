// LockBench: evaluates the rows of one link of a system at inputs that a check varies.
#pragma once

#include <lockstep/system.h>
#include "framework/tools/check/state_check.h"

namespace lockstep {

inline constexpr const char* kPartName[] = {"C", "Ct", "Qhat"};

/// The rows of one link; the jacobian has 6 columns per slot of the system.
struct LockRows {
  Eigen::Matrix<double, Eigen::Dynamic, 3> parts;  ///< a column each: C, Ct, Qhat
  MatX J;

  auto C() const { return parts.col(0); }
  bool all_finite() const { return parts.allFinite() && J.allFinite(); }
  bool operator==(const LockRows& other) const { return parts == other.parts && J == other.J; }
};

class LockBench {
 public:
  LockBench(const System& system, const Lock& link) : system_(system), link_(link) {}

  /// Gathers the link alone; its storage holds `before` when it begins to write.
  LockRows rows(const TestState&, double before = 0);
  /// Gathers the link and another of its pattern as one group.
  std::pair<LockRows, LockRows> rows_of_group(const TestState&, const Lock& other);
  /// Whether the last gather wrote into the padding of the columns, or outside of its storage.
  bool wrote_padding() const { return wrote_padding_; }
  bool wrote_outside() const { return wrote_outside_; }
  /// Integrates the link's own states along the motion from one state to a later one, by its own rates.
  void move_states(const TestState& from, TestState& to) const;

 private:
  void gather(const TestState&, Group, double before);
  LockRows read(std::size_t lane) const;
  void check_bounds();

  const System& system_;
  const Lock& link_;
  Aligned<double> numbers_;
  std::size_t n_lanes_ = 0;
  bool wrote_padding_ = false, wrote_outside_ = false;
};

}  // namespace lockstep
