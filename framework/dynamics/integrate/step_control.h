// How far a step may be wrong, and how long the next one shall be (framework/docs/solvers.md, section 7).
#pragma once

#include "framework/dynamics/integrate/integrator.h"

namespace lockstep {

/// What an error is held against, one number for each quantity over all bodies:
///
///   position  atol_x + rtol X,  rotation  atol_x + rtol R,  velocity  atol_x/(1 s) + rtol V,  angular velocity  ... +
///   rtol W
///
/// X, R, V, W are the largest change of any body over the step, but not less than what its rate at the beginning would
/// make of it: h |v|, h |w|, h |a|, h |alpha| (a body that swings to and fro within one step has moved). They are
/// increments, so that a mechanism far from the origin is no less accurate; for short steps they vanish and atol is
/// what counts. Each integrated state that steers is held against its own change likewise; quadratures are not looked
/// at.
class LOCKSTEP_API ErrorNorm {
 public:
  void set(const Tolerance& tolerance) { tolerance_ = tolerance; }
  const Tolerance& tolerance() const { return tolerance_; }
  /// The first n of State::s are looked at (System::n_steering_states).
  void set_states(int n) { n_s_ = n; }
  /// Scales for the step of h from y0, with the rates `k0` there, to y1 (quaternions not yet normalised).
  void scale(const State& y0, const StateRate& k0, double h, const State& y1);
  /// Scales of a state at rest in itself: X = `length`, R = 1 rad, V and W the present speeds. For the first step.
  void scale(const State& y0, double length);
  /// Largest error over bodies and states, 1 = just met; `error` is the difference of two results at y1.
  double of(const StateRate& error, const State& y1) const;

 private:
  Tolerance tolerance_;
  double x_ = 1, r_ = 1, v_ = 1, w_ = 1;  // weights
  VecX s_;
  int n_s_ = 0;
};

/// Proportional-integral control of the step (Gustafsson 1991): exponents 0.7/p and 0.4/p, safety 0.9, factors 0.2 ...
/// 5, no growth after a rejection.
class LOCKSTEP_API StepControl {
 public:
  explicit StepControl(int order) : p_(order) {}
  void begin() { before_ = kFirst; }
  /// Factor for the next step after one was accepted with this error.
  double accept(double error, bool after_rejection);
  /// Factor for the next try after one was rejected for this error (> 1, or not finite).
  double reject(double error) const;
  void save(Snapshot& out) const { out.put(before_); }
  void restore(const Snapshot& in) { before_ = in.get(); }

 private:
  static constexpr double kFirst = 1e-4;
  int p_;
  double before_ = kFirst;  // error of the step before
};

/// First step by Hairer, Norsett & Wanner 1993, II.4: as long as an Euler step and the change of the rates allow. `f0`,
/// `f1` and `y1` are scratch; nothing beyond `largest` is looked at.
LOCKSTEP_API double guess_first_step(Dynamics&, const State& y0, int order, double largest, ErrorNorm&, StateRate& f0,
                                     StateRate& f1, State& y1);

}  // namespace lockstep
