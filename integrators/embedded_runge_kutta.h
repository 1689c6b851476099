// Embedded explicit Runge-Kutta: two results of different order from the same stages tell the error, which chooses the
// step. What dopri5 and dop853 have in common; they bring their numbers.
#pragma once

#include <vector>

#include "framework/dynamics/integrate/integrator.h"
#include "framework/dynamics/integrate/runge_kutta.h"
#include "framework/dynamics/integrate/singular_rate.h"
#include "framework/dynamics/integrate/step_control.h"
#include "framework/mechanism/params/params.h"
#include "integrators/stiffness.h"

namespace lockstep {

/// Where the stages are evaluated: as they are, on the constraints (see StagesOn), or on the constraints while a stage
/// is near a singular position: when the detector of a solve (SolveReport) falls under 1e-2, until it is above 3e-2.
enum class StagesWhen { plain, manifold, automatic };

/// How an embedded method is asked to work; what its keys say in a scene.
struct EmbeddedOptions {
  bool fixed = false;  ///< steps as told, without error control
  StagesWhen stages = StagesWhen::plain;

  static Keys keys();
  static EmbeddedOptions from(const Params&);
};

/// Steps that violate the constraints by more than 1e-3 of the scene's length before projection are rejected as well.
/// The projection moves the end of a step, so its last stage is no first stage of the next one: every stage is
/// evaluated. A stage that cannot be evaluated (NonFiniteError, SolveError) rejects the step a few times; then the
/// error goes on its way. With the stages on the constraints a chosen step turns no body by more than 0.5 rad.
class LOCKSTEP_API EmbeddedRungeKutta : public Integrator {
 public:
  void begin(Dynamics&, const State&) override;
  StepReport step(Dynamics&, State&, double h) override;
  /// Nested polynomial in theta = (t - t0)/h. Stages that only it needs are evaluated at its first call in a step (by
  /// the dynamics of begin(), whose last values are then those of a stage).
  bool dense(double t, State& out) const override;
  void set_tolerance(const Tolerance& tolerance) override { norm_.set(tolerance); }
  double first_step(Dynamics&, const State&, double largest) override;
  /// Null where the options want more than the plain method.
  const EmbeddedScheme* scheme() const override {
    return options_.fixed || options_.stages != StagesWhen::plain ? nullptr : &scheme_;
  }
  void save(Snapshot&) const override;
  void restore(const Snapshot&) override;

 protected:
  EmbeddedRungeKutta(const EmbeddedScheme& scheme, const EmbeddedOptions& options)
      : scheme_(scheme), options_(options), control_(scheme.tableau.order), watch_(scheme.stability) {}
  bool fixed() const { return options_.fixed; }

 private:
  struct Try {
    double error = 0, violation = 0, violation_after = 0;
    bool landed = false;    ///< projected, and near enough before
    bool singular = false;  ///< to be made again with the stages on the constraints
  };
  void start_step(Dynamics&, const State&);
  bool first_stage(Dynamics&);
  Try attempt(Dynamics&, double h, double limit);
  void finish_step(const Try&, double h, int shifts, State&, StepReport&);
  double estimate(double h);
  bool misplaced(const Try&) const;
  double detector() const;
  bool blind(int stage) const;
  double longest(double h) const;
  double time_to_turn(double angle) const;
  void watch_stiffness(const Dynamics&, double h);
  std::string blame(double h, double t, int rejected) const;
  void prepare_dense() const;

  const EmbeddedScheme& scheme_;
  EmbeddedOptions options_;
  ErrorNorm norm_;
  StepControl control_;
  StiffnessWatch watch_;
  Weights error_w_, second_w_, gap_w_;
  std::vector<Weights> dense_w_;
  Dynamics* dynamics_ = nullptr;
  State start_, end_, landed_;  // of the step: where it began, its end before and after normalisation and projection
  StateRate error_, gap_;       // gap_: end of the last step less its late stage
  VecX a_before_;               // at the beginning of the watch's window
  SingularRate through_;
  StagesOn on_ = StagesOn::plain;
  double h_ = 0;                  // of the last step; 0: there is none
  double landed_t_ = 0;           // its end
  bool singular_ = false;         // automatic: the next step begins with its stages on the constraints
  bool looked_aside_ = false;     // at the beginning of the run, for a singular position there
  bool from_both_sides_ = false;  // the first stage's rates are SingularRate's
  bool first_done_ = false;       // the first stage of the present step stands

  mutable Stages stages_;  // dense() adds its stages when it is called first
  mutable bool dense_ready_ = false;
  mutable std::vector<StateRate> poly_;
};

}  // namespace lockstep
