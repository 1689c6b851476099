// Batch: up to eight copies and their data, one copy per lane. Private to the room.
//
// Arrays of states and rates have n() packs: q, v, s and followed as in State and StateRate, in the batch's own coordinates
// (the last means nothing in a state). Unused lanes repeat the
// first copy.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/memory.h>
#include "framework/dynamics/evaluate/projection_rule.h"
#include "framework/dynamics/integrate/body_error.h"
#include "framework/tools/batch/lane_passes.h"

namespace lockstep::lanes {

using Numbers8 = std::array<double, kLanes>;
using Flags8 = std::array<bool, kLanes>;

/// The result of a projection in one lane.
struct Landing {
  double before = 0, after = 0;  ///< |C|, m
  bool converged = true;
  bool velocities_met = true;  ///< false: the copy goes on alone
};

class LOCKSTEP_API Batch {
 public:
  /// Of copies in joint coordinates (TreeBatch), with the formulation omega in the slots' own (RowBatch). The systems are
  /// set up and suited; `first`: the number of the first of them, for messages. Throws ModelError without trees.
  static std::unique_ptr<Batch> of(std::span<System* const> systems, int first, const CopiesOptions& options);
  virtual ~Batch();

  int size() const { return n_; }
  int first() const { return first_; }
  const Passes& passes() const { return pass_; }
  System& system(int lane) const { return *systems_[static_cast<std::size_t>(lane)]; }
  std::size_t n() const { return n_q_ + n_v_ + n_s_ + n_followed_; }
  std::size_t n_numbers() const { return kLanes * n(); }

  /// Copies a state (q, v, s) to its lane of an array, and back.
  void put(int lane, const State&, double* y) const;
  void get(int lane, const double* y, State&) const;
  void get(int lane, const double* rate, StateRate&) const;
  /// Sets the memory of a copy.
  void remember(int lane, const VecX& z) { memory_[static_cast<std::size_t>(lane)] = z; }
  const VecX& memory(int lane) const { return memory_[static_cast<std::size_t>(lane)]; }

  /// Takes a state of a copy from the slots' own coordinates to those of the batch, and back.
  virtual void to_batch(int lane, State&) const;
  virtual void to_slots(int lane, State&) const;

  /// d/dt of the states y at the times t. Returns true in the lanes whose rows could not be satisfied, or whose numbers
  /// are not finite.
  virtual Flags8 evaluate(const double* y, const Numbers8& t, double* rate) = 0;
  /// Largest accelerations of a slot by the last evaluate(), m/s^2, rad/s^2; in joint coordinates only.
  virtual double largest_a(std::size_t) const { return 0; }
  virtual double largest_alpha(std::size_t) const { return 0; }
  /// Whether the following four are there: errors of steps on the bodies, by squares, NaN where one is none. Else
  /// ErrorNorm finds them copy by copy.
  virtual bool weighs_errors() const { return false; }
  /// Takes the states y for the starts of steps.
  virtual void start_from(const double*, const Numbers8&) {}
  /// What steps of h to the states y at the times t change. Returns true in the lanes whose laws fail.
  virtual Flags8 change_to(const double*, const Numbers8&, const Numbers8&, std::array<Change, kLanes>&) { return {}; }
  /// How an error of q and v moves the states of change_to().
  virtual void weigh(const double*, std::array<Change, kLanes>&) {}
  /// The step of a copy that change_to() saw last is accepted.
  virtual void accept(int) {}
  /// Takes whole turns off the angles of a copy in the states y, as Coordinates::take_off_turns does.
  virtual void take_off_turns(int, double*) const {}
  /// From now on evaluate() sees the pivots, in mechanisms with loops.
  virtual void watch_pivots() {}
  bool watches() const { return watches_; }
  /// Of the last evaluate(): how many pivots are small, and the smallest of the others, relative to its diagonal.
  virtual double n_small(std::size_t) const { return 0; }
  virtual double smallest_pivot(std::size_t) const { return 1; }
  /// Projects positions and velocities in the wanted lanes; quaternions are normalised in all.
  virtual void project(double* y, const Numbers8& t, const Flags8& wanted, std::array<Landing, kLanes>& landed) = 0;

 protected:
  /// n_q, n_v: numbers of a state.
  Batch(std::span<System* const> systems, int first, std::size_t n_q, std::size_t n_v, const CopiesOptions&);

  /// The inputs of one copy's laws; its motions are those that see_motions wrote last.
  Inputs inputs(int lane, const double* y, double t);
  void see_motions(int lane);
  /// act(), which may be user code; what it throws makes the lane a lost one.
  template <class Act>
  void guarded(int lane, Act&& act) {
    try {
      act();
    } catch (const std::bad_alloc&) {
      throw;
    } catch (...) {
      lost_[static_cast<std::size_t>(lane)] = true;
    }
  }
  /// Takes the residuals |C| before the next round of a projection: `going`, the lanes that need it. Returns whether the
  /// last factor is good enough for all of them, which share it.
  static bool next_round(const Numbers8& C, std::array<PositionRounds, kLanes>&, Flags8& going,
                         std::array<Landing, kLanes>&);
  /// The integrated states of a copy, by the last inputs().
  const VecX& states_of(int lane) const { return states_[static_cast<std::size_t>(lane)]; }
  /// Sets the forces of all copies, which are scalar code and applied copy by copy; nothing where there are none.
  void fill_wrench(const double* y, const Numbers8& t);
  /// The motion of a slot, as the present evaluation has it.
  virtual void read_motion(int lane, int slot, Motion& out) const = 0;
  /// Rates of the states of links, and of auxiliaries.
  void state_rates(const double* y, const Numbers8& t, double* rate);

  int n_ = 0, first_ = 0;
  std::size_t n_q_, n_v_, n_s_, n_followed_ = 0;
  int n_controlled_ = 0;  // of the states s, those whose errors control the step
  std::array<System*, kLanes> systems_{};
  Passes pass_;
  bool watches_ = false, has_forces_ = false;
  bool reads_motions_ = false;  // forces, or rates of states
  Flags8 lost_{};               // lanes in which user code threw since this was cleared; alone they are told by name
  Aligned<double> wrench_;      // 6 packs a slot

 private:
  std::vector<int> stateful_;  // numbers of links in force with states of their own
  std::vector<std::size_t>
      integrated_;  // auxiliaries that are evaluated; the others read the power of laws, and there are none
  std::vector<Motion> motions_;
  std::array<VecX, kLanes> states_, memory_;
  VecX wrench_of_one_, rates_of_one_;
  RowTable no_rows_;  // what states of the user's own, which read no solution, get for one
  VecX no_accelerations_, no_multipliers_;
};

/// Arrays of packs.
class Arrays {
 public:
  /// One more, of zeros; not empty.
  std::span<double> add(std::size_t packs) { return all_.emplace_back(kL * std::max<std::size_t>(packs, 1), 0.0); }

 private:
  std::vector<Aligned<double>> all_;
};

/// Writes a number, numbers or a matrix, row after row, of one copy.
inline void put_number(std::span<double> to, std::size_t at, int lane, double value) {
  to[kL * at + static_cast<std::size_t>(lane)] = value;
}
template <class M>
void put_numbers(std::span<double> to, std::size_t at, int lane, const M& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i)
    put_number(to, at + static_cast<std::size_t>(i), lane, values.data()[i]);
}
inline void put_matrix(std::span<double> to, std::size_t at, int lane, const Mat3& A) {
  put_numbers(to, at, lane, Mat3(A.transpose()));
}

/// xx xy xz yy yz zz
inline Eigen::Matrix<double, 6, 1> packed(const Mat3& J) {
  return {J(0, 0), J(0, 1), J(0, 2), J(1, 1), J(1, 2), J(2, 2)};
}

inline bool any(const Flags8& f) {
  return std::ranges::any_of(f, [](bool x) { return x; });
}

}  // namespace lockstep::lanes
