// radau5: RADAU IIA with three stages, order 5, implicit: for stiff mechanisms that are to be accurate.
//
//   Z_i = h sum_j a_ij f(t + c_j h, y0 + Z_j),   y1 = y0 + Z_3
//
// y = (q, v, s) as increments since the beginning of the step (increments.h), f the equations of motion solved for the
// accelerations (index 1, stabilised as the dynamics says); the end of a step is projected like that of an explicit
// method. So positions and velocities have order 5, reactions as well, since they are those of the equations of motion.
#pragma once

#include <memory>

#include "framework/dynamics/integrate/adaptive_stepper.h"
#include "framework/mechanism/params/params.h"
#include "integrators/linearized_motion.h"
#include "integrators/predictive_control.h"
#include "integrators/quintic_output.h"

namespace lockstep {

/// Simplified Newton: one real and one complex factor a step (tangents of forces and constraints at its beginning; the
/// curvature of the rows is left out, which costs an iteration). Error estimate of order 3 by one more solve, step
/// control with prediction (Gustafsson 1994), dense output of local order 6. With `fixed` it steps as told.
class LOCKSTEP_API Radau5 final : public AdaptiveStepper {
 public:
  static TypeInfo type_info();
  static std::unique_ptr<Integrator> make(const Params&);
  explicit Radau5(bool fixed = false);

  IntegratorInfo info() const override;
  void begin(Dynamics&, const State&) override;
  bool dense(double t, State& out) const override { return output_.at(t, out); }
  void set_tolerance(const Tolerance&) final;
  void save(Snapshot& out) const override;
  void restore(const Snapshot& in) override;

 private:
  static constexpr int kStages = 3;
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, kStages>;
  double start_step(Dynamics&, double h) override;
  Attempt attempt(Dynamics&, double h) override;
  void finish_step(Dynamics&, StepReport&) override;
  void guess(double h);
  void linearize(Dynamics&, double h);
  bool solve_stages(Dynamics&, double h, Attempt&);
  void evaluate_stages(Dynamics&, double h);
  double correct(double h);
  double estimate(Dynamics&, double h);
  double size_of(const VecX& y);
  double newton_goal() const;

  double loose_ = 1;  // errors up to this many tolerances are accepted: see set_tolerance
  LinearizedMotion linear_;
  QuinticOutput output_;

  State stage_;
  StateRate rate0_, rate_, difference_;
  Columns Z_, W_, F_, before_;  // stages, transformed, their rates; stages of the step before
  VecX f0_, r_, r2_, y_, y2_, error_, end_rate_v_, end_rate_s_;
  double h_before_ = 0, t_before_ = 0;  // length and end of the step before; 0: there was none
  bool again_ = false;                  // an attempt at this step was rejected
  bool careful_ = true;                 // so, or the first step of a run
};

}  // namespace lockstep
