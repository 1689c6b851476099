// SPDX-License-Identifier: BSD-3-Clause
// Batch: up to eight copies in joint coordinates, one copy per lane. Private to the room.
//
// Arrays of states and rates have n() packs: q, v, s and followed as in State and StateRate (the last means nothing in a
// state). Unused lanes repeat the first copy.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include "framework/dynamics/integrate/body_error.h"
#include "framework/foundation/support/thrown.h"
#include "framework/tools/batch/tree_closures.h"

namespace lockstep::lanes {

/// The result of a projection in one lane.
struct Landing {
  double before = 0, after = 0;  ///< |C|, m
  bool converged = true;
  bool velocities_met = true;  ///< false: the copy continues alone
};

class LOCKSTEP_API Batch {
 public:
  using Trees = std::vector<TreeLayout>;
  /// The trees of copies, one each; none if a copy has none that runs in lanes, `why_not` then gives the reason. The
  /// systems are set up, and suited.
  static Trees trees_of(std::span<System* const> systems, Formulation, std::string& why_not);

  /// `first`: the number of the first of them, for messages. Throws ModelError if trees_of() has none.
  Batch(std::span<System* const> systems, int first, const CopiesOptions&);
  Batch(const Batch&) = delete;
  Batch& operator=(const Batch&) = delete;

  int size() const { return n_; }
  int first() const { return first_; }
  const Passes& passes() const { return pass_; }
  const LaneData& data() const { return data_; }
  System& system(int lane) const { return *systems_[lane]; }
  std::size_t n() const { return n_q_ + n_v_ + n_s_ + n_followed_; }
  std::size_t n_numbers() const { return kLanes * n(); }

  /// Copies a state (q, v, s) to its lane of an array, and back.
  void put(int lane, const State&, double* y) const;
  void get(int lane, const double* y, State&) const;
  /// Sets the memory of a copy.
  void remember(int lane, const VecX& z) { memory_[lane] = z; }
  const VecX& memory(int lane) const { return memory_[lane]; }

  /// Takes a state of a copy from the slots' own coordinates to those of the batch, and back.
  void to_batch(int lane, State&) const;
  void to_slots(int lane, State&) const;

  /// d/dt of the states y at the times t. Returns true in the lanes whose rows could not be satisfied, or whose numbers
  /// are not finite.
  Flags8 evaluate(const double* y, const Numbers8& t, double* rate);
  /// Largest accelerations of a slot by the last evaluate(), m/s^2, rad/s^2.
  double largest_a(int lane) const { return std::sqrt(data_.z.largest[lane]); }
  double largest_alpha(int lane) const { return std::sqrt(data_.z.largest[kLanes + lane]); }
  /// The pack of an array at which the states s begin; how many of them control the step by their errors.
  std::size_t first_state() const { return n_q_ + n_v_; }
  std::size_t n_controlled() const { return static_cast<std::size_t>(systems_[0]->n_error_controlled_states()); }

  // Errors of steps on the bodies: by squares, NaN if one is none.
  /// Takes the states y for the starts of steps.
  void start_from(const double* y, const Numbers8& t);
  /// What steps of h to the states y at the times t change. Returns true in the lanes whose laws fail.
  Flags8 change_to(const double* y, const Numbers8& t, const Numbers8& h, std::array<Change, kLanes>& out);
  /// How an error of q and v moves the states of change_to().
  void weigh(const double* error, std::array<Change, kLanes>& out);
  /// The step of a copy that change_to() saw last is accepted.
  void accept(int lane);
  /// Takes whole turns off the angles of a copy in the states y, as Coordinates::take_off_turns does.
  void take_off_turns(int lane, double* y) const;
  /// From now on evaluate() sees the pivots, in mechanisms with loops.
  void watch_pivots();
  bool watches() const { return watches_; }
  /// Of the last evaluate(): how many pivots are small, and the smallest of the others, relative to its diagonal.
  double n_small(int lane) const { return closures_->n_small(lane); }
  double smallest_pivot(int lane) const { return closures_->smallest_pivot(lane); }
  /// Projects positions and velocities in the wanted lanes; quaternions are normalised in all.
  void project(double* y, const Numbers8& t, const Flags8& wanted, std::array<Landing, kLanes>& landed);

 private:
  const JointTree& tree(int lane) const { return *trees_[lane]; }
  // The inputs of one copy's laws; its motions are those that see_motions wrote last.
  Inputs inputs(int lane, const double* y, double t);
  void see_motions(int lane);
  // act(), which may be user code; what it throws makes the lane a lost one.
  template <class Act>
  void guarded(int lane, Act&& act) {
    if (!succeeds(act)) lost_[lane] = true;
  }
  // Sets the forces of all copies, which are scalar code and applied copy by copy; nothing where there are none.
  void fill_wrench(const double* y, const Numbers8& t);
  // The motion of a slot, as the present evaluation has it.
  void read_motion(int lane, int slot, Motion& out) const;
  // Rates of the states of links, and of auxiliaries.
  void state_rates(const double* y, const Numbers8& t, double* rate);
  void lay_out(const Trees&);
  void fill_joints();
  void put_heights(int lane);
  void follow_laws(double* rate) const;
  void fill_laws(const double* y, const Numbers8& t);
  void fill_laws_of(std::size_t node, int lane, double t);
  void fill_closures(const double* y, const Numbers8& t);
  void move(const double* y, const Numbers8& t, bool with_positions);
  void see_ends();
  void read(std::array<Change, kLanes>& out) const;
  void gather(const double* y, const Numbers8& t);
  void normalize(double* y) const;
  void advance(double* y, const double* d) const;
  Numbers8 largest_of(std::size_t at) const;
  bool project_positions(double* y, const Numbers8& t, const Flags8& wanted, std::array<Landing, kLanes>&);
  void project_velocities(double* y, const Numbers8& t, const Flags8& wanted, bool factored,
                          std::array<Landing, kLanes>&);

  int n_ = 0, first_ = 0;
  std::size_t n_q_ = 0, n_v_ = 0, n_s_ = 0, n_followed_ = 0;
  std::array<System*, kLanes> systems_{};
  Passes pass_;
  bool watches_ = false, has_forces_ = false;
  bool reads_motions_ = false;  // forces, or rates of states
  Flags8 lost_{};               // lanes in which user code threw since this was cleared; reported by the scalar code
  std::vector<int> stateful_;   // numbers of links in force with states of their own
  std::vector<std::size_t>
      integrated_;  // auxiliaries that are evaluated; the others read the power of laws, and there are none
  std::vector<Motion> motions_;
  std::array<VecX, kLanes> states_, memory_;  // states_: the integrated ones, by the last inputs()
  VecX wrench_of_one_, rates_of_one_;
  RowTable no_rows_;  // what states of the user's own, which read no solution, get for one
  VecX no_accelerations_, no_multipliers_;

  std::array<std::shared_ptr<const JointTree>, kLanes> trees_;
  Stabilization stabilization_;
  LaneData data_;
  std::array<int, 3> axes_{};  // of its plan
  std::unique_ptr<TreeClosures> closures_;
  std::vector<std::size_t> node_of_;  // of each slot
  Arrays arrays_;                     // of data_.z
  Aligned<double> half_;              // angle of each node
  Aligned<double> start_, now_;       // of steps: end::size packs a node
  alignas(64) std::array<double, 4 * kLanes> sizes_{};
};

}  // namespace lockstep::lanes
