// Error norm and step size control (framework/docs/solvers.md, section 7), and the limits that every adaptive step keeps.
#pragma once

#include "framework/dynamics/integrate/integrator.h"

namespace lockstep {

/// Weights an error against the tolerance, one number for each quantity over all bodies:
///
///   position  atol_x + rtol X,        rotation          atol_x + rtol R,
///   velocity  atol_x/(1 s) + rtol V,  angular velocity  atol_x/(1 s) + rtol W
///
/// X, R, V, W are the largest change of any body over the step, but not less than what its rate at the beginning would
/// make of it: h |v|, h |w|, h |a|, h |alpha| (a body that swings to and fro within one step has moved). They are
/// increments, so that a mechanism far from the origin is as accurate; for short steps they vanish and atol counts.
/// Each integrated state that feeds back on the motion is weighted by its own change likewise; quadratures are ignored.
class LOCKSTEP_API ErrorNorm {
 public:
  void set(const Tolerance& tolerance) { tolerance_ = tolerance; }
  const Tolerance& tolerance() const { return tolerance_; }
  /// The first n of State::s count (System::n_error_controlled_states).
  void set_states(int n) { n_s_ = n; }
  /// Scales for the step of h from y0, with the rates `k0` there, to y1 (quaternions not yet normalised).
  void scale(const State& y0, const StateRate& k0, double h, const State& y1);
  /// Scales of a state by itself: X = `length`, R = 1 rad, V and W the present speeds. For the first step.
  void scale(const State& y0, double length);
  /// Largest error over bodies and states, 1 = just met; `error` is the difference of two results at y1.
  double of(const StateRate& error, const State& y1) const;

 private:
  Tolerance tolerance_;
  double x_ = 1, r_ = 1, v_ = 1, w_ = 1;  // weights
  VecX s_;
  int n_s_ = 0;
};

/// Chooses the next step from the error of the last one. Errors are in tolerances, 1 = just met.
class LOCKSTEP_API StepControl {
 public:
  virtual ~StepControl();
  virtual void begin() = 0;
  /// Factor for the next step after one of h was accepted with this error and so many Newton iterations.
  virtual double accept(double h, double error, int iterations, bool after_rejection) = 0;
  /// Factor for the next attempt after one was rejected for this error (> 1, or not finite).
  virtual double reject(double error, int iterations) const = 0;
  virtual void save(Snapshot&) const = 0;
  virtual void restore(const Snapshot&) = 0;
};

/// Proportional-integral control (Gustafsson 1991): exponents 0.7/p and 0.4/p, safety 0.9, factors 0.2 ... 5, no growth
/// after a rejection.
class LOCKSTEP_API PiControl final : public StepControl {
 public:
  explicit PiControl(int order) : p_(order) {}
  void begin() override { before_ = kFirst; }
  double accept(double h, double error, int iterations, bool after_rejection) override;
  double reject(double error, int iterations = 0) const override;
  void save(Snapshot& out) const override { out.put(before_); }
  void restore(const Snapshot& in) override { before_ = in.get(); }

 private:
  static constexpr double kFirst = 1e-4;
  int p_;
  double before_ = kFirst;  // error of the step before
};

/// True when a step that was asked for as `asked` has shrunk to rounding at t.
LOCKSTEP_API bool step_vanished(double t, double h, double asked);
/// True when steps only shrink towards a point where nothing can be evaluated: report that failure, not the small step.
LOCKSTEP_API bool step_stalled(double t, double h);
/// Whether the end of a step was near enough to the constraints before its projection: within 1e-3 of `length`, the
/// scene's. What is farther off is an error of the step that no estimate saw.
LOCKSTEP_API bool end_is_near(bool converged, double violation, double length);
/// The same of the end that project_end() treated; always where positions are not projected. `fixed`: it must only have
/// converged.
LOCKSTEP_API bool end_is_near(const Dynamics&, const ProjectReport&, bool fixed = false);

/// First step by Hairer, Norsett & Wanner 1993, II.4: as long as an Euler step and the change of the rates allow. `f0`,
/// `f1` and `y1` are scratch; nothing beyond `largest` is evaluated.
LOCKSTEP_API double guess_first_step(Dynamics&, const State& y0, int order, double largest, ErrorNorm&, StateRate& f0,
                                     StateRate& f1, State& y1);

}  // namespace lockstep
