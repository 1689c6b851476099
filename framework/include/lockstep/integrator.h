// Integrator: a time-stepping method, one step at a time. Registered by name, built in or from a plugin.
#pragma once

#include <string>

#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/memory.h>
#include <lockstep/state.h>

namespace lockstep {

struct EmbeddedScheme;

/// What a run has to know of a method.
struct IntegratorInfo {
  std::string name;
  int order = 1;
  bool implicit = false, adaptive = false;
  int evaluations = 1;  ///< of the equations of motion per step
};

/// Error weights: atol_x + relative |increment scale| for positions and rotations (m, rad), atol_v = atol_x / (1 s).
struct Tolerance {
  double relative = 1e-6;
  double atol_x = 1e-8;
};

/// What one step did.
struct StepReport {
  double h = 0;                ///< step made, s
  double h_next = 0;           ///< step advised, s; 0: none (fixed step)
  double error = 0;            ///< estimate in tolerances, 1 = just met; 0 where there is none
  int rejected = 0;            ///< attempts rejected before this step
  double violation = 0;        ///< |C| before projection, m
  double violation_after = 0;  ///< |C| of the new state, m
  bool manifold = false;       ///< its stages were evaluated on the constraints, as near singular positions
  bool stiff = false;          ///< damped fast modes limit the step, not accuracy: an implicit method is cheaper
};

/// A method that makes steps.
class LOCKSTEP_API Integrator {
 public:
  virtual ~Integrator();
  virtual IntegratorInfo info() const = 0;
  /// Where its class comes from: "built in", a plugin's name, or "" for a class of the host. Set by the registry.
  const std::string& origin() const { return origin_; }
  void set_origin(std::string origin) { origin_ = std::move(origin); }
  /// Sizes the scratch. Called at the start and whenever the set of active links changed or the state was rewound.
  virtual void begin(Dynamics&, const State&) = 0;
  /// One step of at most h (s) from `state`, which becomes the new state (projected where the dynamics says so). An
  /// adaptive method may step less; a rejected attempt leaves no trace. Throws StepError, and whatever an evaluation
  /// throws; `state` is then unchanged.
  virtual StepReport step(Dynamics&, State& state, double h) = 0;
  /// State inside the last step, t0 <= t <= t1: unit quaternions, not projected, memory and links of t0; the method's
  /// own dense output. As the end of the step is projected and this is not, dense(t1) differs from it by that small
  /// move. Right after begin() it gives the state of begin(). Returns false by default, always: a cubic Hermite fallback
  /// would be of lower order. The step loop then ends steps on the output times instead.
  virtual bool dense(double t, State& out) const;
  virtual void set_tolerance(const Tolerance&);
  /// The method's guess of the first step, at most `largest`, s; 0: none (fixed step).
  virtual double first_step(Dynamics&, const State&, double largest);
  /// The numbers of an explicit Runge-Kutta method (framework/dynamics/integrate/tableau.h), by which others make its
  /// steps: Copies in vector lanes. Null, the default: only step() makes them.
  virtual const EmbeddedScheme* scheme() const;
  /// History and controller: with the State all that a checkpoint or a step taken back needs. Default: nothing.
  virtual void save(Snapshot&) const;
  virtual void restore(const Snapshot&);

 private:
  std::string origin_;
};

/// For errors that leave a method's code at time t. What it refuses (StepError, ModelError) keeps its type; what an
/// evaluation threw inside goes on as it is.
LOCKSTEP_API ErrorContext context_of(const Integrator&, double t);

}  // namespace lockstep
