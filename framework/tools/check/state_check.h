// SPDX-License-Identifier: BSD-3-Clause
// StateCheck: what check_lock and check_force share. Their object gives numbers at a state, and is checked in random
// states, in time, and along full revolutions.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lockstep/author/check.h>
#include <lockstep/error.h>
#include <lockstep/system.h>
#include "framework/tools/check/compare.h"
#include "framework/tools/check/draw.h"
#include "framework/tools/check/slope.h"

namespace lockstep {

/// Inputs that own their numbers, so that a check can vary them one by one.
struct TestState {
  double t = 0;
  std::vector<Motion> motions;  ///< of the ground, then of each slot
  VecX s, z;

  Inputs in() const {
    return {t, motions, {s.data(), static_cast<std::size_t>(s.size())}, {z.data(), static_cast<std::size_t>(z.size())}};
  }
  Motion& slot(int k) { return motions[k + 1]; }
  const Motion& slot(int k) const { return motions[k + 1]; }
  /// Sets every velocity to zero.
  void stop() {
    for (Motion& O : motions) O.v.setZero(), O.w.setZero();
  }
};

/// The start of a set-up system, at time t.
TestState start_of(const System&, double t);
/// Bodies moved by up to `reach` times their distance and turned by up to `turn` rad, with random velocities; angular
/// ones up to 2 rad/s.
TestState random_state(const System&, const TestState& about, Draw&, double reach, double turn);
/// The state x seconds later without accelerations: x + v t, e exp(w t/2).
TestState coasted(const TestState&, double x);

class StateCheck {
 public:
  virtual ~StateCheck() = default;
  void run();

 protected:
  using Output = std::function<VecX(const TestState&)>;

  /// `remembering`: the object's memory, which begins at `first_memory` in z; null: it has none.
  StateCheck(const System&, CheckReport&, const CheckOptions&, const Remembering* remembering, int first_memory);

  // -- the object
  /// Its rows with their numbers.
  virtual MatX numbers(const TestState&) = 0;
  virtual std::string name(Eigen::Index row, Eigen::Index column) const = 0;
  virtual void breakpoints(double t0, double t1, std::vector<double>& out) const = 0;
  virtual std::string why_not_finite() const;
  virtual std::string place(const TestState&) const { return ""; }  ///< "x = 0.02 m, rz = 90 deg"; "": unknown
  virtual ErrorContext context() const = 0;  ///< of what its code throws

  // -- its checks
  /// What it is made of, into slots_ and n_timed_. False: nothing else can be checked.
  virtual bool description() = 0;
  virtual void at_state() = 0;  ///< at the state under test
  virtual void turns() = 0;
  virtual void between(const TestState&, const TestState&) {}       ///< finds a jump or a corner of the constraint
  virtual std::string blame(std::string own) const { return own; }  ///< where to look: `own`, or whom it follows from

  /// A finding, with here() behind it.
  void add(const std::string& key, const std::string& what, std::string look, double weight = 0);
  std::string here() const;  ///< " (seed 7, state 3)", or "" outside of the states
  const std::string& body(int slot) const { return system_.body_of_slot(slot).name; }
  int n_freedoms(int slot) const;
  /// Unknown k of a slot as Differences::moved counts them: "the velocity of body 'cam' along the world's y axis".
  std::string unknown_name(int slot, int k) const;
  /// Updates the object's memory as after an accepted step.
  void accept_step(TestState&) const;
  /// df/d(unknown k of a slot) at a state.
  Slope derivative(const TestState&, int slot, int k, const Output& f) const;

  /// K or D of `sum` against the derivatives of f, a wrench per slot. `scale`: entries below 1e-7 of it are rounding.
  void check_tangent(const TangentSum& sum, bool damping, const Output& f, double scale);
  /// Whether gradients differ across a branch.
  static bool bends(const VecX& a, const VecX& b) { return (b - a).norm() > 0.01 * a.norm(); }
  /// Three revolutions of a slot about `sense` times z of a marker: the first n_turned_ columns must not jump.
  /// `who`: the rotating object.
  void turn_about_z(int slot, const Marker&, double sense, const std::string& who);

  const System& system_;
  CheckReport& report_;
  const CheckOptions& options_;
  const Remembering* remembering_;
  int first_memory_;
  int n_;                   // slots of the system
  std::vector<int> slots_;  // of the object
  bool is_link_ = false;    // a row may change its sign as a whole, and be finite only near the start
  int n_timed_ = 0;         // columns that must not jump in time
  int n_turned_ = 0;        // columns that must not jump in a turn
  double length_ = 1;       // m, to which translations are compared
  TestState state_;         // under test
  MatX is_;                 // the numbers there
  int index_ = -1;          // of that state
  double quiet_ = 0;        // s; no breakpoint is within it

 private:
  void run_all();
  bool find_state(Draw&);
  void same_again();
  void memory();
  void jumps();
};

}  // namespace lockstep
