// StateCheck: what check_lock and check_force share: random states of a system, and the differences taken at them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lockstep/author/check.h>
#include <lockstep/system.h>
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
  void stop();
};

/// The start of a set-up system, at time t.
TestState start_of(const System&, double t);
/// Bodies moved by up to `reach` times their distance and turned by up to `turn` rad, with random velocities; angular
/// ones up to 2 rad/s.
TestState random_state(const System&, const TestState& about, Draw&, double reach, double turn);
/// The state x seconds later without accelerations: x + v t, e exp(w t/2).
TestState coasted(const TestState&, double x);
/// The motion of a body turned about an axis through a point of the world.
Motion turned(const Motion&, const Vec3& center, const Vec3& axis, double angle);

/// Sets the system up. False if user code wrote where it must not: that is reported, and nothing else can be checked.
bool set_up(System&, CheckReport&);

class StateCheck {
 protected:
  using Output = std::function<void(const TestState&, VecX& out)>;
  using Breakpoints = std::function<void(double t0, double t1, std::vector<double>& out)>;

  /// `remembering`: the object's memory, which begins at `first_memory` in z; null: it has none.
  StateCheck(const System&, CheckReport&, const CheckOptions&, const Remembering* remembering, int first_memory);

  void add(const std::string& key, std::string what, std::string look, double weight = 0);
  std::string here() const;  ///< "(seed 7, state 3)"
  const std::string& body(int slot) const { return system_.body_of_slot(slot).name; }
  int n_freedoms(int slot) const;
  /// Unknown k of a slot as Differences::moved counts them: "the velocity of body 'cam' along the world's y axis".
  std::string unknown_name(int slot, int k) const;

  /// A random time; no breakpoint is within quiet_ s of it.
  double draw_time(Draw&, const Breakpoints&);
  /// Another random state at the same time.
  TestState other_state() const;
  /// Updates the object's memory as after an accepted step.
  void accept_step(TestState&) const;

  /// df/d(unknown k of a slot) at the state under test.
  Slope derivative(int slot, int k, const Output& f) const;

  /// How a tangent is called in messages.
  struct TangentWords {
    std::string quantity;  ///< "K", "the change"
    std::string function;  ///< what was differenced: "apply()"
    std::string look;
  };
  /// K or D of `sum` against the derivatives of f, a wrench per slot. `scale`: entries below 1e-7 of it are rounding.
  void check_tangent(const TangentSum& sum, bool damping, const std::vector<int>& slots, const Output& f, double scale,
                     const TangentWords&);

  const System& system_;
  CheckReport& report_;
  const CheckOptions& options_;
  const Remembering* remembering_;
  int first_memory_;
  int n_;              // slots of the system
  double length_ = 1;  // m, to which translations are compared
  TestState state_;    // under test
  int index_ = 0;      // of that state
  double quiet_ = 0;   // s
};

}  // namespace lockstep
