// RowBatch: copies in the slots' own coordinates, with all rows of their links. Private to the room.
#pragma once

#include <lockstep/lock.h>
#include "framework/tools/batch/batch.h"

namespace lockstep::lanes {

class LOCKSTEP_API RowBatch final : public Batch {
 public:
  /// Copies of one mechanism, set up and suited.
  RowBatch(std::span<System* const> systems, int first, const CopiesOptions&);

  const Plan& plan() const { return plan_; }
  Flags8 evaluate(const double* y, const Numbers8& t, double* rate) override;
  void watch_pivots() override;
  double n_small(std::size_t lane) const override { return pivots_[lane]; }
  double smallest_pivot(std::size_t lane) const override { return pivots_[kL + lane]; }
  void project(double* y, const Numbers8& t, const Flags8& wanted, std::array<Landing, kLanes>& landed) override;

 private:
  void read_motion(int lane, int slot, Motion& out) const override;
  void fill_masses();
  void fill_frames();
  void fill_laws(const double* y, const Numbers8& t);
  const MarkerLock& lock(int lane, const Link& link) const {
    return static_cast<const MarkerLock&>(*system(lane).links()[static_cast<std::size_t>(link.link)]);
  }
  int first_solution();
  void see_pivots();
  Flags8 check_rows(int corrections);
  void gather_rows(const double* y, const Numbers8& t);
  void solve_for(const double* c, const Flags8& wanted, bool fresh);
  bool project_positions(double* y, const Numbers8& t, const Flags8& wanted, std::array<Landing, kLanes>&);
  void project_velocities(double* y, const Flags8& wanted, bool factored);
  void move(double* y);

  Stabilization stabilization_;
  Plan plan_;
  bool has_laws_ = false;
  bool rows_moved_ = false;  // since the last factor
  bool floors_known_ = false;
  Numbers z_;
  Aligned<double> mass_, inverse_, gravity_, frames_, law_, body_, af_, a_, J_, Y_, A_, x_, c_, scale_, diagonal_, p_,
      E_, r_, C_, Ct_, Cd_, length_;
  alignas(64) std::array<double, kLanes * 4> scratch_{};
  alignas(64) Numbers8 unmet_{};
  alignas(64) std::array<double, 3 * kLanes> floors_{};        // one pack per RowKind
  alignas(64) std::array<double, 3 * kLanes> pivot_floors_{};  // one pack per RowKind
  alignas(64) std::array<double, 2 * kLanes> pivots_{};        // n_small, smallest_pivot
};

}  // namespace lockstep::lanes
