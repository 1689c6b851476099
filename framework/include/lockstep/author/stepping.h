// SPDX-License-Identifier: BSD-3-Clause
// What integrators are made of: tableaus, stages, step control.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/integrator.h>
#include <lockstep/author/memory.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>

namespace lockstep {

// Explicit Runge-Kutta methods as data: Integrator::scheme().

/// Coefficients of an explicit Runge-Kutta method. The arrays live as long as the program.
struct Tableau {
  int order = 1;              ///< order of convergence
  int n_stages = 1;           ///< number of stages of a step
  int n_all = 1;              ///< the same with those that only dense output needs
  int stride = 1;             ///< numbers in a row of `a`
  const double* a = nullptr;  ///< n_all rows of `stride`; row i is read up to column i - 1
  const double* b = nullptr;  ///< n_stages weights of the end of the step
  const double* c = nullptr;  ///< n_all nodes, as parts of the step
};

/// A combination of stages: those weights that are not zero.
struct LOCKSTEP_API Weights {
  static constexpr int kMost = 16;         ///< stages at most
  std::size_t n = 0;                       ///< number of weights that are not zero
  std::array<std::size_t, kMost> stage{};  ///< the stage of each: the first n entries
  std::array<double, kMost> w{};           ///< the weights: the first n entries

  Weights() = default;
  /// From the weights of all stages, zeros included: n_all numbers, kMost at most.
  Weights(const double* all, int n_all);
};

/// Coefficients of an explicit method, embedded or with a fixed step. The arrays live as long as the program.
struct EmbeddedScheme {
  const char* name = "";          ///< name of the method
  Tableau tableau;                ///< its stages
  int end_stage = 0;              ///< the stage that is the rate at the end of the step
  int late_stage = 0;             ///< the first other stage at c = 1
  double stability = 0;           ///< h |lambda| at the end of its interval of stability on the negative axis
  const double* error = nullptr;  ///< error = h sum e_i k_i; null: fixed step, only name and tableau count
  const double* second =
      nullptr;                ///< a second, coarser estimate: then the error is e5^2/sqrt(e5^2 + 0.01 e3^2); or null
  int n_dense = 0;            ///< polynomials of the dense output beyond the cubic ones: h sum d_i k_i
  const double* d = nullptr;  ///< n_dense rows of tableau.n_all
};

// Stages: the stages of one step of an explicit Runge-Kutta method, for any tableau.
//
//   k_i = f(t + c_i h, y + h sum_j a_ij k_j),  y1 = y + h sum_i b_i k_i,  y = (q, v, s)
//
// In the stages quaternions follow their plain rates e' = e (0, w)/2; the end of the step is normalised.

/// The state at which a stage's equations of motion are evaluated.
enum class StagesOn {
  plain,    ///< at the stage as it is
  manifold  ///< at its projection onto the constraints: f(P(y)) equals f there and is smooth across singular
            ///< configurations; about twice the cost
};

/// Conditioning of one evaluation: near a singular configuration the accelerations follow from vanishing pivots.
struct Conditioning {
  double detector = NAN;                                   ///< SolveReport::detector
  double pivot = std::numeric_limits<double>::infinity();  ///< SolveReport::smallest_pivot
  /// The detector, small near a singular configuration; for a solver without one the smallest pivot, which redundant
  /// rows make small everywhere.
  double indicator() const { return std::isnan(detector) ? pivot : detector; }
};

/// Stages of one step of an explicit Runge-Kutta method.
class LOCKSTEP_API Stages {
 public:
  /// Sizes everything for states like this one; only this allocates. `watch`: conditioning() is wanted, which costs the
  /// solver time.
  void begin(const Tableau&, const State&, bool watch = false);
  /// Evaluates k_first ... k_(last - 1) of a step of h, s, from y; the others are kept. False: a stage could not be
  /// projected onto the constraints. Throws what Dynamics::rate throws.
  bool evaluate(Dynamics&, const State& y, double h, int first, int last, StagesOn on = StagesOn::plain);
  /// out = y + h sum_i w_i k_i, at the time y.t + h; the memory and joints of `out` stay as they are.
  void combine(const State& y, double h, const Weights& w, State& out) const;
  /// out = h sum_i w_i k_i.
  void sum(double h, const Weights& w, StateRate& out) const;
  /// The end of the step: combine() with b.
  void end(const State& y, double h, State& out) const { combine(y, h, b_, out); }
  const StateRate& k(int i) const { return k_[static_cast<std::size_t>(i)]; }  ///< rates of stage i
  /// Sets the rates of stage i to k, found by other means, with perfect conditioning. Throws ModelError for rates of
  /// another size.
  void put(int i, const StateRate& k);
  /// Conditioning of stage i; perfect if it is not watched.
  const Conditioning& conditioning(int i) const { return conditioning_[static_cast<std::size_t>(i)]; }
  const Tableau& tableau() const { return tableau_; }  ///< the coefficients

 private:
  Tableau tableau_;
  std::vector<Weights> a_;
  Weights b_;
  State stage_;
  std::vector<StateRate> k_;
  bool watch_ = false;
  std::array<Conditioning, Weights::kMost> conditioning_{};
};

/// Puts the end of a step on the constraints: unit quaternions, then the projection if the dynamics projects, to
/// round-off if the stages are projected too. Without projection the report has |C| alone.
LOCKSTEP_API ProjectReport project_end(Dynamics&, State&, StagesOn on = StagesOn::plain);
/// The same for a method that cannot reject a step: throws StepError if the projection does not converge. `t`, `h`:
/// beginning and length of the step, s.
LOCKSTEP_API ProjectReport project_end_or_throw(Dynamics&, State&, const char* method, double t, double h,
                                                StagesOn on = StagesOn::plain);
/// One error from the estimates of two orders: e5^2 / sqrt(e5^2 + 0.01 e3^2), Hairer, Norsett & Wanner 1993, II.10.
/// Infinite if one is not finite.
LOCKSTEP_API double combined_error(double e5, double e3);

/// Copies t, q, v and s; memory and joints, which do not change during a step, stay as they are in `out`.
LOCKSTEP_API void copy_motion(const State& in, State& out);
/// Writes to `to` the counted angles of `from`, advanced by the mean of their rates at both: for methods that find
/// positions before integrated states.
LOCKSTEP_API void lead_angles(Dynamics&, const State& from, State& to);
/// copy_motion() by exchange of the vectors: `in` is scratch afterwards.
LOCKSTEP_API void take_motion(State& in, State& out);

// Error norm and step size control (framework/docs/solvers.md, section 7), and the limits of every adaptive step.

/// Reference values for the errors of a body.
struct BodyWeights {
  double x = 1,  ///< of its position, m
      r = 1,     ///< of its orientation, rad
      v = 1,     ///< of its velocity, m/s
      w = 1;     ///< of its angular velocity, rad/s
};

/// Measures the error of a step in tolerances. There is one weight per quantity, the same for all bodies:
///
///     position  atol_x + rtol X,        rotation          atol_x + rtol R,
///     velocity  atol_x/(1 s) + rtol V,  angular velocity  atol_x/(1 s) + rtol W
///
/// X, R, V, W are the largest changes of any body over the step, but not less than its rate at the beginning would
/// give: h |v|, h |w|, h |a|, h |alpha| (a body that swings back within one step has moved). They are increments,
/// so that accuracy does not depend on the distance from the origin; in short steps they vanish and atol_x decides.
/// Each integrated state that acts on the motion is weighted by its own change likewise; quadratures are ignored.
class LOCKSTEP_API ErrorNorm {
 public:
  void set(const Tolerance& tolerance) { tolerance_ = tolerance; }  ///< sets the tolerance
  const Tolerance& tolerance() const { return tolerance_; }         ///< as set
  /// Sets how many of State::s count: the first n (System::n_error_controlled_states).
  void set_states(int n) { n_s_ = n; }
  /// Sets the weights for the step of h, s, from y0, with the rates k0 there, to y1 (quaternions not yet normalised).
  void scale(const State& y0, const StateRate& k0, double h, const State& y1);
  /// Sets the weights from one state, for the first step: X = `length`, m, R = 1 rad, V and W the present speeds.
  void scale(const State& y0, double length);
  /// Largest error over bodies and states, 1 = just met; infinite if one is not finite. `error` is the difference of
  /// two results at y1, the state that the weights were set for; in joint coordinates it is converted to the motions of
  /// the bodies.
  double of(const StateRate& error, const State& y1);

 private:
  // Motions of the slots at a state in joint coordinates, the ground first. s: the states that control the step.
  struct Moving {
    double t = std::numeric_limits<double>::quiet_NaN();
    VecX q, v, s;
    std::shared_ptr<const Coordinates> coordinates;
    std::vector<Motion> motions;
    bool are_of(const State&) const;
    void at(const State&, int n_s);
  };

  Tolerance tolerance_;
  BodyWeights weights_;
  VecX s_;
  int n_s_ = 0;
  Moving before_, now_;  // at y0 and y1
  VecX dx_, dv_;         // errors of the slots, 6 each
};

/// Chooses the next step from the error of the last one. Errors are in tolerances, 1 = just met.
class LOCKSTEP_API StepControl {
 public:
  virtual ~StepControl();
  /// Forgets the history.
  virtual void begin() = 0;
  /// Factor from an accepted step of h, s, to the next one, by its error and its number of Newton iterations.
  /// `after_rejection`: an attempt at this step was rejected.
  virtual double accept(double h, double error, int iterations, bool after_rejection) = 0;
  /// Factor from an attempt that was rejected for this error (> 1, or not finite) to the next attempt.
  virtual double reject(double error, int iterations) const = 0;
  virtual void save(Snapshot&) const = 0;     ///< saves the history
  virtual void restore(SnapshotReader&) = 0;  ///< takes back what save() wrote
};

/// Proportional-integral control (Gustafsson 1991): exponents 0.7/p and 0.4/p, safety 0.9, factors 0.2 ... 5, no growth
/// after a rejection.
class LOCKSTEP_API PiControl final : public StepControl {
 public:
  explicit PiControl(int order) : p_(order) {}  ///< `order`: p
  void begin() override { before_ = kFirst; }
  double accept(double h, double error, int iterations, bool after_rejection) override;
  double reject(double error, int iterations = 0) const override;
  void save(Snapshot& out) const override { out.put(before_); }
  void restore(SnapshotReader& in) override { before_ = in.get(); }

 private:
  static constexpr double kFirst = 1e-4;
  int p_;
  double before_ = kFirst;  // error of the step before
};

/// Whether a step h, s, has shrunk to round-off at t, s. `asked`: the requested step, s.
LOCKSTEP_API bool step_vanished(double t, double h, double asked);
/// Whether steps only shrink towards a time at which nothing can be evaluated: then the failure there is reported, not
/// the small step.
LOCKSTEP_API bool step_stalled(double t, double h);
/// Whether the end of a step is near enough to the constraints: its projection converged, and |C| before it,
/// `violation`, is within 1e-3 of System::length. More is an error of the step that the estimate did not detect.
LOCKSTEP_API bool end_is_near(bool converged, double violation, double length);
/// The same after project_end(); true if positions are not projected. `fixed`: converged is enough.
LOCKSTEP_API bool end_is_near(const Dynamics&, const ProjectReport&, bool fixed = false);

/// First step, s, by Hairer, Norsett & Wanner 1993, II.4: as long as an Euler step and the change of the rates allow,
/// at most `largest`; nothing beyond it is evaluated. f0, f1 and y1 are scratch.
LOCKSTEP_API double guess_first_step(Dynamics&, const State& y0, int order, double largest, ErrorNorm&, StateRate& f0,
                                     StateRate& f1, State& y1);

// AdaptiveStepper: the step driver of every method that writes one attempt at a step: repeats attempts until one is
// accepted, shortens the step, puts its end on the constraints, reports.

/// Outcome of one attempt at a step.
struct Attempt {
  bool accepted = false;  ///< the end of the step was found and is accurate enough
  double error = 0;       ///< estimate in tolerances, 1 = just met; 0 if there is none
  int iterations = 0;     ///< of Newton's method, for StepControl
  double next = 0;        ///< step to attempt next if this one is rejected, s; 0: the control's choice, or half
};

/// Base of methods that write one attempt at a step. An attempt is rejected for its error, for an end that is far off
/// the constraints before projection (end_is_near), or because its evaluation fails (NonFiniteError, SolveError); after
/// eight failures of one step the error is rethrown. If the step shrinks to round-off, step() throws StepError.
///
/// Without a step control it makes fixed steps: the error of an evaluation is thrown at once, and an end that cannot be
/// projected is a StepError.
class LOCKSTEP_API AdaptiveStepper : public Integrator {
 public:
  ~AdaptiveStepper() override;
  void begin(Dynamics&, const State&) override;
  StepReport step(Dynamics&, State&, double h) final;
  void set_tolerance(const Tolerance& tolerance) override { norm_.set(tolerance); }
  double first_step(Dynamics&, const State&, double largest) override;
  void save(Snapshot&) const override;
  void restore(SnapshotReader&) override;

 protected:
  /// `order`: for the guess of the first step. `control` null: fixed steps.
  AdaptiveStepper(int order, std::unique_ptr<StepControl> control);
  bool fixed() const { return !control_; }  ///< whether it makes fixed steps

  // What a method writes.
  /// Prepares all attempts at a step from start_. Returns the step to attempt first, s, at most h.
  virtual double start_step(Dynamics&, double h) = 0;
  /// Makes one attempt at a step of h, s, from start_ and writes its end to end_.
  virtual Attempt attempt(Dynamics&, double h) = 0;
  /// Called after acceptance: prepares the next step and dense output. end_ is the end before projection, landed_ after
  /// it.
  virtual void finish_step(Dynamics&, StepReport&) {}
  /// Puts the end of a step on the constraints. Default: lockstep::project_end.
  virtual ProjectReport project_end(Dynamics&, State&);
  /// Advice about a step that shrank to round-off, for the message of the error.
  virtual std::string advice() const;

  /// Throws the StepError of an implicit method with fixed steps whose iteration did not converge.
  [[noreturn]] void newton_failed(double h, const char* advice) const;

  ErrorNorm norm_;  ///< measures errors by the tolerance
  State start_,     ///< beginning of the step
      end_,         ///< its end before projection
      landed_;      ///< its end after projection

 private:
  bool land(Dynamics&, double h, StepReport&);

  int order_;
  std::unique_ptr<StepControl> control_;
  StateRate guess0_, guess1_;  // scratch of first_step()
};

/// When stages are projected onto the constraints (see StagesOn).
enum class StagesWhen {
  plain,     ///< never
  manifold,  ///< always
  automatic  ///< near a singular configuration: from a Conditioning::indicator below 1e-2, or a tenth of the regular
             ///< one if that is less, until it is three times as large
};

}  // namespace lockstep
