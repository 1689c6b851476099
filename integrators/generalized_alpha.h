// generalized_alpha: Chung and Hulbert's method on the Lie group, constraints at position and velocity level
// (stabilised index 2). One numerical damping for everything that the step does not resolve.
//
//   q1 = q0 (+) ( h v0 + h^2 ((1/2 - beta) a0 + beta a1) + u ),   v1 = v0 + h ((1 - gamma) a0 + gamma a1)
//   (1 - alpha_m) a1 + alpha_m a0 = (1 - alpha_f) v1' + alpha_f v0'
//   M v1' + Jh^T lambda = f(q1, v1),   Jh v1 + Ct = 0,   C(q1) = 0
//
// The step is the turn of the rotations, by the exponential; u, of the size of the method's own error, brings positions
// onto C = 0 in the metric of Newton's matrix. a is the method's own, some way off v' at the same instant.
#pragma once

#include <memory>

#include "framework/dynamics/evaluate/implicit.h"
#include "framework/dynamics/integrate/adaptive_stepper.h"
#include "framework/mechanism/params/params.h"
#include "integrators/quintic_output.h"

namespace lockstep {

/// Order 2, fixed step; each Newton iteration gathers once and solves twice, by one factor a step where it converges
/// fast. rho_infinity: what is left of an infinitely stiff mode after a step, 0 (all damped) ... 1 (nothing damped).
/// Starts from consistent accelerations; a step of another length than the one before rescales a - v'. `adaptive`: it
/// chooses its steps, by the leading terms of its own error in positions and velocities.
class LOCKSTEP_API GeneralizedAlpha final : public AdaptiveStepper {
 public:
  static TypeInfo type_info();
  static std::unique_ptr<Integrator> make(const Params&);
  explicit GeneralizedAlpha(double rho_infinity = 0.8, bool adaptive = false);

  IntegratorInfo info() const override;
  void begin(Dynamics&, const State&) override;
  bool dense(double t, State& out) const override { return output_.at(t, out); }
  void save(Snapshot& out) const override;
  void restore(const Snapshot& in) override;

  double rho_infinity() const { return rho_; }
  const VecX& lambda() const { return lambda_; }  ///< of the end of the last step, one a row; order 2

 private:
  double start_step(Dynamics&, double h) override;
  Attempt attempt(Dynamics&, double h) override;
  void finish_step(Dynamics&, StepReport&) override;
  ProjectReport project_end(Dynamics&, State&) override;
  bool solve(Dynamics&, double h);
  void update_end(double h);
  double correct(Dynamics&, double h, bool anew);
  void settle_reactions(const Evaluation&);
  double estimate(double h);
  void filter(Eigen::Ref<VecX> out);

  double rho_, alpha_m_, alpha_f_, beta_, gamma_, kappa_;
  NewtonMatrix matrix_;
  QuinticOutput output_;
  VecX vd_, a_, sd_, as_, lambda_;       // v', a, s', its own, multipliers at the beginning of the step
  VecX vd1_, a1_, sd1_, as1_, lambda1_;  // and at its end
  VecX a0_, as0_;                        // a_ and as_ for the length of this step
  VecX bend_;                            // (v1' - v0')/h of the step before
  VecX u_, y_, sd_now_, force_, zero_, rows_, C_, Cd_, du_, al_, mu_;  // of the linear systems
  VecX friction_, friction1_, lambda_try_;                             // of forces that read reactions
  StateRate rate_, difference_;
  double h_ = 0, t_ = 0;  // length and end of the step before; 0: there was none
};

}  // namespace lockstep
