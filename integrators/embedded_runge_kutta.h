// Embedded explicit Runge-Kutta: two results of different order from the same stages tell the error, which chooses the
// step. What dopri5 and dop853 have in common; they bring their numbers.
#pragma once

#include <vector>

#include "framework/dynamics/integrator.h"
#include "integrators/runge_kutta.h"
#include "integrators/step_control.h"

namespace lockstep {

/// The numbers of an embedded method; the arrays live as long as the program.
struct EmbeddedScheme {
  const char* name = "";
  Tableau tableau;  ///< its stage `end_stage` is the rate at the end of the step
  int end_stage = 0;
  const double* error = nullptr;   ///< error = h sum e_i k_i
  const double* second = nullptr;  ///< a second, coarser one, or null: then error e5^2 / sqrt(e5^2 + 0.01 e3^2)
  int n_dense = 0;                 ///< polynomials of the dense output beyond the cubic ones: h sum d_i k_i
  const double* d = nullptr;       ///< n_dense rows of tableau.n_all
};

/// Steps that violate the constraints by more than 1e-3 of the scene's length before projection are rejected as well.
/// The projection moves the end of a step, so its last stage is no first stage of the next one: every stage is
/// evaluated. A stage that cannot be evaluated (NonFiniteError, SolveError) rejects the step a few times; then the
/// error goes on its way.
class LOCKSTEP_API EmbeddedRungeKutta : public Integrator {
 public:
  void begin(Dynamics&, const State&) override;
  StepReport step(Dynamics&, State&, double h) override;
  /// Nested polynomial in theta = (t - t0)/h. Stages that only it needs are evaluated at its first call in a step (by
  /// the dynamics of begin(), whose last values are then those of a stage).
  bool dense(double t, State& out) const override;
  void set_tolerance(const Tolerance& tolerance) override { norm_.set(tolerance); }
  double first_step(Dynamics&, const State&, double largest) override;
  void save(Snapshot& out) const override { control_.save(out); }
  void restore(const Snapshot& in) override { control_.restore(in), h_ = 0; }

 protected:
  EmbeddedRungeKutta(const EmbeddedScheme& scheme, bool fixed)
      : scheme_(scheme), fixed_(fixed), control_(scheme.tableau.order) {}
  bool fixed() const { return fixed_; }

 private:
  struct Try {
    double error = 0, violation = 0, violation_after = 0;
    bool landed = false;  ///< projected, and near enough before
  };
  Try attempt(Dynamics&, double h);
  double estimate(double h);
  double shorter(const Try&) const;
  void prepare_dense() const;

  const EmbeddedScheme& scheme_;
  bool fixed_;
  ErrorNorm norm_;
  StepControl control_;
  Dynamics* dynamics_ = nullptr;
  State start_, end_, landed_;  // of the step: where it began, its end before and after normalisation and projection
  StateRate error_;
  double h_ = 0;  // of the last step; 0: there is none

  mutable Stages stages_;  // dense() adds its stages when it is called first
  mutable bool dense_ready_ = false;
  mutable std::vector<StateRate> poly_;
};

}  // namespace lockstep
