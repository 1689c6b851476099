// Batch: up to eight copies and their numbers, one copy a lane. Private to the room.
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

/// What a projection did to one lane.
struct Landing {
  double before = 0, after = 0;  ///< |C|, m
  bool converged = true;
};

class LOCKSTEP_API Batch {
 public:
  /// All of one mechanism, set up and suited; `first` among all copies, for messages.
  Batch(std::span<System* const> systems, int first, const CopiesOptions&);

  int size() const { return n_; }
  int first() const { return first_; }
  const Plan& plan() const { return plan_; }
  const Passes& passes() const { return pass_; }
  System& system(int lane) const { return *systems_[lane]; }
  std::size_t n_numbers() const { return kLanes * plan_.n(); }

  /// A state into its lane of an array, and back (q, v, s).
  void put(int lane, const State&, double* y) const;
  void get(int lane, const double* y, State&) const;
  void get(int lane, const double* rate, StateRate&) const;
  /// Memory of the copy's forces, from here on.
  void remember(int lane, const VecX& z) { memory_[lane] = z; }
  const VecX& memory(int lane) const { return memory_[lane]; }

  /// d/dt of the states y at the times t. True in the lanes whose rows could not be met.
  Flags8 evaluate(const double* y, const Numbers8& t, double* rate);
  /// Both projections, in the lanes that are wanted; quaternions are normalised in all.
  void project(double* y, const Numbers8& t, const Flags8& wanted, std::array<Landing, kLanes>& landed);

 private:
  void fill_masses();
  void fill_frames();
  void fill_laws(const double* y, const Numbers8& t);
  void fill_wrench(const double* y, const Numbers8& t);
  void state_rates(const double* y, const Numbers8& t, double* rate);
  Inputs inputs(int lane, const double* y, double t);
  int first_solution();
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
  Numbers z_;
  Aligned<double> mass_, inverse_, gravity_, frames_, law_, body_, af_, a_, wrench_, J_, Y_, A_, x_, c_, scale_,
      diagonal_, pivot_, E_, r_, C_, Ct_, Cd_, length_;
  alignas(64) std::array<double, kLanes * 4> scratch_{};
  alignas(64) Numbers8 unmet_{};
  alignas(64) std::array<double, 3 * kLanes> floors_{};  // one pack per RowKind
  std::vector<Motion> motions_;
  std::array<VecX, kLanes> states_, memory_;
  VecX wrench_of_one_, rates_of_one_;
};

}  // namespace lockstep::lanes
