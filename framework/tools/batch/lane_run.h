// SPDX-License-Identifier: BSD-3-Clause
// A run of eight copies in lanes: what it holds. Internal to batch runs.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include <lockstep/author/stepping.h>
#include "framework/dynamics/integrate/singular_passage.h"
#include "framework/dynamics/simulate/clock.h"
#include "framework/tools/batch/copy_run.h"

namespace lockstep::lanes {

// What SingularPassage asks of the stages of an attempt.
struct Pivots {
  double most = 0;      // small ones
  double smallest = 1;  // of the others, relative to its diagonal
  void add(double n_small, double least) { most = std::max(most, n_small), smallest = std::min(smallest, least); }
};

struct Lane {
  Lane(const System& system, const RunTask& task)
      : clock(system, task.method, task.loop), control(task.scheme.tableau.order) {}
  bool going = false;     // steps in lanes
  bool rejected = false;  // an attempt at the present step was rejected
  bool lands = false;     // the present attempt ends on the target
  double asked = 0;       // the first attempt at it, s
  double largest = 0;     // the next one after a rejection, s; 0: no limit
  std::size_t next = 0;   // output time
  Clock clock;
  Clock::Target target;
  PiControl control;
  Pivots first, stages;   // of the first stage, and of all of them
  double usual = 0;       // number of small pivots: those of redundant rows
  double near_below = 0;  // a smaller one of the others is near a singular position
  // Whether a stage of the attempt is near a singular position: there more pivots are small than elsewhere.
  bool near_singular() const {
    return std::max(first.most, stages.most) > usual || std::min(first.smallest, stages.smallest) < near_below;
  }
};

/// Runs all copies of a batch in lanes; run_alone finishes those that fail there.
class LaneRun {
 public:
  LaneRun(Batch& batch, const RunTask& task, std::span<CopyReport> reports)
      : batch_(batch),
        task_(task),
        reports_(reports),
        fixed_(task.scheme.error == nullptr),
        tableau_(task.scheme.tableau) {
    for (int i = 0; i < tableau_.n_stages; ++i) a_.emplace_back(tableau_.a + i * tableau_.stride, i);
    b_ = Weights(tableau_.b, tableau_.n_stages);
    if (task.scheme.error) error_w_ = Weights(task.scheme.error, tableau_.n_stages);
    if (task.scheme.second) second_w_ = Weights(task.scheme.second, tableau_.n_stages);
    for (Aligned<double>* v : {&y_, &stage_, &end_, &error_}) v->assign(batch.n_numbers(), 0.0);
    k_.resize(tableau_.n_stages);
    for (Aligned<double>& k : k_) k.assign(batch.n_numbers(), 0.0);
    for (int l = 0; l < kLanes; ++l) lanes_.emplace_back(batch.system(l), task);
  }

  void run(std::span<const State> starts) {
    if (task_.watches) batch_.watch_pivots();
    begin(starts);
    while (std::any_of(lanes_.begin(), lanes_.end(), [](const Lane& lane) { return lane.going; }) && goes_on()) {
      choose_steps();
      attempt();
    }
  }

 private:
  void begin(std::span<const State> starts);
  void read(int lane, const double* y, double t, State& out) const;
  double first_step(int lane, const State&) const;
  void find_redundancy(int lane, const State&);
  void cross_jump(int lane, double t);
  void see(int lane);
  void arrive(int lane);
  void tell_step(int lane, bool jumped);
  bool goes_on();
  void choose_steps();
  void attempt();
  Flags8 evaluate_stages();
  void combine_stages(const Weights&, const double* y, double* out);
  void estimate(Numbers8& error, Flags8& failed);
  void accept(int lane, double error);
  void reject(int lane, double factor);
  void leave(int lane);
  void fail(int lane, const Error&);
  // act(), which calls laws; false, and the copy has failed, if one of them throws.
  template <class Act>
  bool survives(int lane, Act&& act) {
    try {
      act();
      return true;
    } catch (const Error& error) {
      return fail(lane, error), false;
    }
  }
  void park(int lane);

  Batch& batch_;
  const RunTask& task_;
  std::span<CopyReport> reports_;
  bool fixed_;
  Tableau tableau_;
  std::vector<Weights> a_;
  Weights b_, error_w_, second_w_;
  std::vector<Lane> lanes_;
  Aligned<double> y_, stage_, end_, error_;
  std::vector<Aligned<double>> k_;
  alignas(64) Numbers8 t_{}, h_{};
  bool first_done_ = false;             // the first stage is evaluated: no lane has moved since
  Numbers8 first_a_{}, first_alpha_{};  // largest accelerations there
  bool jumped_ = false;                 // a copy was moved otherwise than by a step
  State state_, told_;                  // scratch of one lane
  StateInputs inputs_;
  std::vector<State> starts_;  // in the coordinates of the batch
};

}  // namespace lockstep::lanes
