// SPDX-License-Identifier: BSD-3-Clause
// Integrator: a time-stepping method, one step at a time. Registered by name, built in or from a plugin.
#pragma once

#include <string>
#include <utility>

#include <lockstep/author/memory.h>
#include <lockstep/error.h>
#include <lockstep/state.h>

namespace lockstep {

class Dynamics;
struct EmbeddedScheme;

/// Properties of a method that a run needs.
struct IntegratorInfo {
  std::string name;       ///< name in the registry and in messages
  int order = 1;          ///< order of convergence
  bool implicit = false,  ///< it solves nonlinear equations in each step
      adaptive = false;   ///< it chooses its steps by an estimate of its error
  int evaluations = 1;    ///< of the equations of motion per step; of an implicit method a rough number
  /// It supports states in any coordinates (Dynamics::rates), also joint coordinates; states without q and v only if it
  /// has a scheme(), or is one of the library with fixed steps.
  bool joint = false;
  bool passes_singular = false;  ///< it passes singular configurations, near which accelerations are ill-conditioned
};

/// Error of a step that is allowed: atol_x + relative |increment| for positions (m) and rotations (rad), with
/// atol_x/(1 s) in place of atol_x for velocities (ErrorNorm).
struct Tolerance {
  double relative = 1e-6;  ///< relative to the increments of the step
  double atol_x = 1e-8;    ///< absolute: m, rad, m/s and rad/s
};
/// This relative tolerance with a hundredth of it as the absolute one, as "tolerance" of a scene has it. Throws as
/// check_tolerance().
LOCKSTEP_API Tolerance tolerance_of(double relative);
/// Throws ModelError for a tolerance that is not above zero, is below round-off, or allows any error.
LOCKSTEP_API void check_tolerance(const Tolerance&);

/// Report of one step.
struct StepReport {
  double h = 0;                ///< length of the step, s
  double h_next = 0;           ///< length advised for the next, s; 0: none (fixed step)
  double error = 0;            ///< estimate in tolerances, 1 = just met; 0 if there is none
  int rejected = 0;            ///< attempts rejected before this step
  double violation = 0;        ///< |C| before projection, m
  double violation_after = 0;  ///< |C| of the new state, m
  bool manifold = false;       ///< its stages were projected onto the constraints, as near singular configurations
  bool stiff = false;          ///< damped fast modes, not accuracy, limit the step: an implicit method is cheaper
};

/// Steps of a run whose errors stayed above the tolerance because smaller ones could not be reached.
struct UnmetTolerance {
  long steps = 0;    ///< how many
  double first = 0,  ///< end of the first of them, s
      largest = 0,   ///< the largest of their errors, in tolerances
      lost = 0;      ///< root of the sum of squares of their lengths times their excess errors, in tolerances, s:
                     ///< the round-off of one step is independent of the others
  /// Counts a step that ended at t if its error is such a one.
  LOCKSTEP_API void count(const StepReport&, double t);
};

/// A time-stepping method. It may keep a history of earlier steps; the state itself belongs to the caller.
class LOCKSTEP_API Integrator {
 public:
  virtual ~Integrator();
  /// Name, order and kind of the method.
  virtual IntegratorInfo info() const = 0;
  /// Origin of its class: "built in", a plugin's name, or "" for a class of the host. Set by the registry.
  const std::string& origin() const { return origin_; }
  void set_origin(std::string origin) { origin_ = std::move(origin); }  ///< called by the registry
  /// Sizes the scratch and forgets the history. Called at the start and whenever the active joints changed or the
  /// state was changed or taken back. Not called at the breakpoint of a law: a method whose history does not fit after
  /// it compares the state of step() with the one that it returned.
  virtual void begin(Dynamics&, const State&) = 0;
  /// Makes one step of at most h, s, from `state`, which becomes the new state (projected if the options of the
  /// dynamics require it). An adaptive method may make a shorter step; a rejected attempt leaves no trace. Throws
  /// StepError, and the errors of an evaluation; `state` is then unchanged.
  virtual StepReport step(Dynamics&, State& state, double h) = 0;
  /// The method's own dense output: the state at t inside the last step, t0 <= t <= t1, with unit quaternions, not
  /// projected, with the memory and joints of t0. The end of a step is projected and this is not, so dense(t1) differs
  /// from it by that small move. Right after begin() it gives the state of begin(). False if the method has none,
  /// the default (a cubic Hermite polynomial would be of lower order): the step loop then ends steps on the output
  /// times.
  virtual bool dense([[maybe_unused]] double t, [[maybe_unused]] State& out) const { return false; }
  /// Sets the error of a step that is allowed. Default: ignored, for fixed steps.
  virtual void set_tolerance(const Tolerance&) {}
  /// Guess of the first step from this state, s, at most `largest`; 0, the default: none (fixed step).
  virtual double first_step(Dynamics&, const State&, [[maybe_unused]] double largest) { return 0; }
  /// The coefficients of an explicit Runge-Kutta method whose steps evaluate every stage again. Null, the default: not
  /// known.
  virtual const EmbeddedScheme* scheme() const { return nullptr; }
  /// Saves history and step control: with the State, all that a checkpoint or a step taken back needs. Default:
  /// nothing.
  virtual void save(Snapshot&) const {}
  /// Takes back what save() wrote, in the same order, also in another object after begin(). Default: nothing.
  virtual void restore(SnapshotReader&) {}
  /// Whether save() writes all that the next steps read, so that a checkpoint continues to the last bit; false for
  /// methods of other libraries that do not expose their history. Default: true.
  virtual bool saves_all() const { return true; }

 private:
  std::string origin_;
};

/// The context of errors that leave a method's code at time t, s. StepError and ModelError of the method keep their
/// type; errors of an evaluation inside it pass unchanged.
LOCKSTEP_API ErrorContext context_of(const Integrator&, double t);

}  // namespace lockstep
