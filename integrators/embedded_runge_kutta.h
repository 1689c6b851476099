// Embedded explicit Runge-Kutta: two results of different order from the same stages estimate the error, which chooses
// the step. What rk4, dopri5 and dop853 have in common; they bring their numbers.
#pragma once

#include <vector>

#include "framework/dynamics/integrate/adaptive_stepper.h"
#include "framework/dynamics/integrate/singular_passage.h"
#include "framework/mechanism/params/params.h"
#include "integrators/stiffness.h"

namespace lockstep {

/// Options of an embedded method; what its keys mean in a scene.
struct EmbeddedOptions {
  bool fixed = false;  ///< steps as told, without error control
  StagesWhen stages = StagesWhen::plain;

  static Keys keys();
  static EmbeddedOptions from(const Params&);
};

/// The projection moves the end of a step, so its last stage is not the first stage of the next one: every stage is
/// evaluated.
class LOCKSTEP_API EmbeddedRungeKutta : public AdaptiveStepper {
 public:
  void begin(Dynamics&, const State&) override;
  /// Nested polynomial in theta = (t - t0)/h. Stages that only it needs are evaluated at its first call in a step (by
  /// the dynamics of begin(), whose last values are then those of a stage). False for a scheme without an estimate.
  bool dense(double t, State& out) const override;
  void set_tolerance(const Tolerance&) override;
  double first_step(Dynamics&, const State&, double largest) override;
  /// Null where the options ask for more than the plain method.
  const EmbeddedScheme* scheme() const override;
  void save(Snapshot&) const override;
  void restore(const Snapshot&) override;

 protected:
  EmbeddedRungeKutta(const EmbeddedScheme& scheme, const EmbeddedOptions& options);

 private:
  double start_step(Dynamics&, double h) override;
  Attempt attempt(Dynamics&, double h) override;
  void finish_step(Dynamics&, StepReport&) override;
  ProjectReport project_end(Dynamics&, State&) override;
  std::string advice() const override;
  double estimate(double h);
  void prepare_dense() const;

  const EmbeddedScheme& scheme_;
  SingularPassage passage_;
  StiffnessWatch watch_;
  Weights error_w_, second_w_, gap_w_;
  std::vector<Weights> dense_w_;
  Dynamics* dynamics_ = nullptr;
  StateRate error_, gap_;    // gap_: end of the last step less its late stage
  double h_ = 0;             // of the last step; 0: there is none
  double landed_t_ = 0;      // its end
  bool first_done_ = false;  // the first stage of the present step is evaluated

  mutable Stages stages_;  // dense() adds its stages when it is called first
  mutable bool dense_ready_ = false;
  mutable std::vector<StateRate> poly_;
};

}  // namespace lockstep
