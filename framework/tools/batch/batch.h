// Batch: up to eight copies and their data, one copy per lane. Private to the room.
//
// Arrays of states and rates have Plan::n() packs: q, v, s as in State. Unused lanes repeat the first copy.
#pragma once

#include <array>
#include <span>

#include <lockstep/dynamics.h>
#include <lockstep/memory.h>
#include "framework/tools/batch/lane_passes.h"

namespace lockstep::lanes {

using Numbers8 = std::array<double, kLanes>;
using Flags8 = std::array<bool, kLanes>;

/// The result of a projection in one lane.
struct Landing {
  double before = 0, after = 0;  ///< |C|, m
  bool converged = true;
};

class LOCKSTEP_API Batch {
 public:
  /// Copies of one mechanism, set up and suited; `first`: the number of the first of them, for messages.
  Batch(std::span<System* const> systems, int first, const CopiesOptions&);

  int size() const { return n_; }
  int first() const { return first_; }
  const Plan& plan() const { return plan_; }
  const Passes& passes() const { return pass_; }
  System& system(int lane) const { return *systems_[lane]; }
  std::size_t n_numbers() const { return kLanes * plan_.n(); }

  /// Copies a state (q, v, s) to its lane of an array, and back.
  void put(int lane, const State&, double* y) const;
  void get(int lane, const double* y, State&) const;
  void get(int lane, const double* rate, StateRate&) const;
  /// Sets the memory of a copy.
  void remember(int lane, const VecX& z) { memory_[lane] = z; }
  const VecX& memory(int lane) const { return memory_[lane]; }

  /// d/dt of the states y at the times t. Returns true in the lanes whose rows could not be satisfied.
  Flags8 evaluate(const double* y, const Numbers8& t, double* rate);
  /// From now on evaluate() sees the pivots, in mechanisms with loops.
  void watch_pivots();
  bool watches() const { return watches_; }
  /// Of the last evaluate(): how many pivots are small, and the smallest of the others, relative to its diagonal.
  double n_small(std::size_t lane) const { return pivots_[lane]; }
  double smallest_pivot(std::size_t lane) const { return pivots_[kL + lane]; }
  /// Projects positions and velocities in the wanted lanes; quaternions are normalised in all.
  void project(double* y, const Numbers8& t, const Flags8& wanted, std::array<Landing, kLanes>& landed);

 private:
  void fill_masses();
  void fill_frames();
  void fill_laws(const double* y, const Numbers8& t);
  void fill_wrench(const double* y, const Numbers8& t);
  void state_rates(const double* y, const Numbers8& t, double* rate);
  Inputs inputs(int lane, const double* y, double t);
  int first_solution();
  void see_pivots();
  Flags8 check_rows(int corrections);
  void gather_rows(const double* y, const Numbers8& t);
  void solve_for(const double* c, const Flags8& wanted, bool fresh);
  bool project_positions(double* y, const Numbers8& t, const Flags8& wanted, std::array<Landing, kLanes>&);
  void project_velocities(double* y, const Flags8& wanted, bool factored);
  void move(double* y);

  int n_ = 0, first_ = 0;
  std::array<System*, kLanes> systems_{};
  Stabilization stabilization_;
  Passes pass_;
  Plan plan_;
  bool has_laws_ = false, has_forces_ = false;
  bool rows_moved_ = false;  // since the last factor
  bool watches_ = false, floors_known_ = false;
  Numbers z_;
  Aligned<double> mass_, inverse_, gravity_, frames_, law_, body_, af_, a_, wrench_, J_, Y_, A_, x_, c_, scale_,
      diagonal_, p_, E_, r_, C_, Ct_, Cd_, length_;
  alignas(64) std::array<double, kLanes * 4> scratch_{};
  alignas(64) Numbers8 unmet_{};
  alignas(64) std::array<double, 3 * kLanes> floors_{};        // one pack per RowKind
  alignas(64) std::array<double, 3 * kLanes> pivot_floors_{};  // one pack per RowKind
  alignas(64) std::array<double, 2 * kLanes> pivots_{};        // n_small, smallest_pivot
  std::vector<Motion> motions_;
  std::array<VecX, kLanes> states_, memory_;
  VecX wrench_of_one_, rates_of_one_;
};

}  // namespace lockstep::lanes
