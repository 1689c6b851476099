// What integrators are made of: stages, tableaus, step control.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/export.h>
#include <lockstep/integrator.h>
#include <lockstep/memory.h>

namespace lockstep {

// Explicit Runge-Kutta methods as data: Integrator::scheme().


/// Coefficients of a method; the arrays live as long as the program.
struct Tableau {
  int order = 1;
  int n_stages = 1;           ///< of a step
  int n_all = 1;              ///< with those that only dense output needs
  int stride = 1;             ///< numbers in a row of `a`
  const double* a = nullptr;  ///< n_all rows, those above the diagonal are not read
  const double* b = nullptr;
  const double* c = nullptr;
};

/// The weights of a combination of stages that are not zero.
struct LOCKSTEP_API Weights {
  static constexpr int kMost = 16;
  std::size_t n = 0;
  std::array<std::size_t, kMost> stage{};
  std::array<double, kMost> w{};

  Weights() = default;
  Weights(const double* all, int n_all);
};

/// The numbers of an explicit method, embedded or with a fixed step; the arrays live as long as the program.
struct EmbeddedScheme {
  const char* name = "";
  Tableau tableau;  ///< its stage `end_stage` is the rate at the end of the step
  int end_stage = 0;
  int late_stage = 0;              ///< another one at c = 1
  double stability = 0;            ///< h |lambda| at the end of its interval of stability on the negative axis
  const double* error = nullptr;   ///< error = h sum e_i k_i; null: fixed step, none of the others count
  const double* second = nullptr;  ///< a second, coarser one, or null: then error e5^2 / sqrt(e5^2 + 0.01 e3^2)
  int n_dense = 0;                 ///< polynomials of the dense output beyond the cubic ones: h sum d_i k_i
  const double* d = nullptr;       ///< n_dense rows of tableau.n_all
};


// Stages: those of one step of an explicit Runge-Kutta method, for every method that brings a tableau.
//
//   k_i = f(t + c_i h, y + h sum_j a_ij k_j),  y1 = y + h sum_i b_i k_i,  y = (q, v, s)
//
// In the stages quaternions follow their plain rates e' = e (0, w)/2; the end of the step is normalised.


/// Where the equations of motion are evaluated: at the stage as it is, or at its projection onto the constraints. The
/// field f(P(y)) equals f on the constraints and is smooth across singular positions; it costs about twice as much.
enum class StagesOn { plain, manifold };

/// Conditioning of one evaluation: near a singular position the accelerations come from what is left of vanishing
/// pivots.
struct Conditioning {
  double detector = std::numeric_limits<double>::infinity();  ///< of SolveReport; infinite where the solver has none
  double pivot = std::numeric_limits<double>::infinity();     ///< smallest
  double residual = 0;
  /// How far from singular. Without a detector: the smallest pivot, which redundant rows make small everywhere.
  double indicator() const { return detector < std::numeric_limits<double>::infinity() ? detector : pivot; }
};

/// Stages of a Runge-Kutta step.
class LOCKSTEP_API Stages {
 public:
  /// Sizes everything; the only place that allocates. `watch`: conditioning() is needed, which costs the solver time.
  void begin(const Tableau&, const State&, bool watch = false);
  /// k_first ... k_(last - 1) of a step of h from y; the earlier ones are kept. False: a stage could not be brought
  /// onto the constraints.
  bool evaluate(Dynamics&, const State& y, double h, int first, int last, StagesOn on = StagesOn::plain);
  /// out = y + h sum_i w_i k_i and the time y.t + h; memory and links stay as they are in `out`.
  void combine(const State& y, double h, const Weights& w, State& out) const;
  /// out = h sum_i w_i k_i.
  void sum(double h, const Weights& w, StateRate& out) const;
  /// The end of the step: combine() with b.
  void end(const State& y, double h, State& out) const { combine(y, h, b_, out); }
  const StateRate& k(int i) const { return k_[static_cast<std::size_t>(i)]; }
  /// Puts the rates of stage i, known by other means.
  void put(int i, const StateRate& k);
  /// Of stage i when watched; else perfect.
  const Conditioning& conditioning(int i) const { return conditioning_[static_cast<std::size_t>(i)]; }
  /// Singularity indicator of the step: the smallest of its stages.
  double indicator() const;

 private:
  Tableau tableau_;
  std::vector<Weights> a_;
  Weights b_;
  State stage_;
  std::vector<StateRate> k_;
  bool watch_ = false;
  std::array<Conditioning, Weights::kMost> conditioning_{};
};

/// Puts the end of a step on the constraints: unit quaternions, then the projection where the dynamics says so, to
/// round-off when the stages are on the constraints too. `before` and `after` are |C|, m.
LOCKSTEP_API ProjectReport project_end(Dynamics&, State&, StagesOn on = StagesOn::plain);
/// The same for a method that cannot reject: StepError when the projection does not converge.
LOCKSTEP_API ProjectReport project_end_or_throw(Dynamics&, State&, const char* method, double t, double h,
                                                StagesOn on = StagesOn::plain);
/// The error of a step of h from t whose end could not be projected.
LOCKSTEP_API StepError end_not_projected(const ProjectReport&, const std::string& method, double t, double h);
/// One error from the estimates of two orders: e5^2 / sqrt(e5^2 + 0.01 e3^2), Hairer, Norsett & Wanner 1993, II.10.
LOCKSTEP_API double combined_error(double e5, double e3);

/// Scratch of the size of a state.
LOCKSTEP_API StateRate sized_like(const State&);
/// out = in, without the links' set and the memory, which do not change during a step.
LOCKSTEP_API void copy_motion(const State& in, State& out);
/// The same by exchange: `in` is scratch afterwards.
LOCKSTEP_API void take_motion(State& in, State& out);


// Error norm and step size control (framework/docs/solvers.md, section 7), and the limits that every adaptive step keeps.


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


// AdaptiveStepper: the step driver of every method that writes one attempt at a step: repeats attempts until one is
// accepted, shortens the step, puts its end on the constraints, reports.


/// What came of one attempt at a step.
struct Attempt {
  bool accepted = false;  ///< the end of the step was found and is accurate enough
  double error = 0;       ///< estimate in tolerances, 1 = just met; 0 where there is none
  int iterations = 0;     ///< of Newton's method, for the control
  double next = 0;        ///< step to attempt next should this one be rejected, s; 0: the control's choice, or half
  bool shifted = false;   ///< rejected for where it ended, not for its error: the next step may grow
};

/// An attempt whose evaluation fails (NonFiniteError, SolveError) is rejected up to eight times, then the error is
/// rethrown; so is one whose end is far off the constraints before projection (end_is_near). Without a control it makes
/// fixed steps: nothing is estimated, an evaluation's error is thrown at once, and an end that cannot be projected is a
/// StepError.
class LOCKSTEP_API AdaptiveStepper : public Integrator {
 public:
  ~AdaptiveStepper() override;
  void begin(Dynamics&, const State&) override;
  StepReport step(Dynamics&, State&, double h) final;
  void set_tolerance(const Tolerance& tolerance) override { norm_.set(tolerance); }
  double first_step(Dynamics&, const State&, double largest) override;
  void save(Snapshot&) const override;
  void restore(const Snapshot&) override;

 protected:
  /// `order` of the guess of the first step. No control: fixed steps.
  AdaptiveStepper(int order, std::unique_ptr<StepControl> control);
  bool fixed() const { return !control_; }

  // What a method writes.
  /// What no attempt changes, from start(). Returns the step to attempt first, at most h.
  virtual double start_step(Dynamics&, double h) = 0;
  /// One attempt at a step of h from start(): its end into end_.
  virtual Attempt attempt(Dynamics&, double h) = 0;
  /// After acceptance: what the next step and dense output need. end_ is the end before, landed_ after projection.
  virtual void finish_step(Dynamics&, StepReport&) {}
  /// Puts the end of a step on the constraints.
  virtual ProjectReport project_end(Dynamics&, State&);
  /// What to do about a step that shrank to nothing, in words.
  virtual std::string advice() const;

  /// StepError of an implicit method with fixed steps.
  [[noreturn]] void newton_failed(double h, const char* advice) const;

  ErrorNorm norm_;
  State start_, end_, landed_;  // of the step: its beginning, its end before and after projection

 private:
  bool land(Dynamics&, double h, StepReport&);

  int order_;
  std::unique_ptr<StepControl> control_;
  StateRate f0_, f1_;  // scratch of the first step
};


// SingularRate: the rates at a state that moves through a singular position. There the rows do not determine the branch
// that the motion follows; a little before and a little behind they do.
//
//   a(+-d) at P(q (+) +-d v/|v|),  m(d) = (a(d) + a(-d))/2,  a = (15 m(d) - 6 m(2 d) + m(3 d))/10 + O(d^6)


/// Rates at a singular position, from both of its sides.
class LOCKSTEP_API SingularRate {
 public:
  /// Sizes the scratch.
  void begin(const State&);
  /// Rates from states 0.01 rad (or of the scene's length) to both sides along the velocity, and twice and three times
  /// as far; right to about 1e-9. False, and nothing in `out`, when the mechanism is at rest, when it cannot be brought
  /// onto the constraints there, or when the sides disagree: then several motions go on from here.
  bool find(Dynamics&, const State&, StateRate& out);

 private:
  void probe_along_forces(Dynamics&, const State&);
  bool probe(Dynamics&, const State&, double delta, double time, StateRate& mean);

  State off_;  // the state beside it
  StateRate ahead_, behind_;
  std::array<StateRate, 3> mean_;
};


// SingularPassage: how an explicit method passes singular positions, where the rows do not determine the accelerations.
//
// Near one its stages are evaluated on the constraints; a step whose late stage is ill-conditioned, or whose estimate is
// spoilt by such a stage, is moved: a slightly different one ends elsewhere.


/// Where the stages are evaluated: as they are, on the constraints (see StagesOn), or on the constraints while a stage
/// is near a singular position: when the singularity indicator (SolveReport::detector) falls under 1e-2, until it is
/// above 3e-2.
enum class StagesWhen { plain, manifold, automatic };

/// How steps go through a singular position.
class LOCKSTEP_API SingularPassage {
 public:
  SingularPassage(StagesWhen when, const char* method) : when_(when), method_(method) {}
  void begin(const State&);
  /// Whether it needs the conditioning of the stages.
  bool active() const { return when_ != StagesWhen::plain; }
  void set_tolerance(double relative) { relative_ = relative; }

  // -- a step from y
  void start_step();
  StagesOn stages_on() const { return on_; }
  /// The first stage into `stages`; in a singular position its rates come from both sides of it (SingularRate). False:
  /// it could not be brought onto the constraints. StepError where several motions go on from the start of a run.
  bool first_stage(Dynamics&, const State& y, Stages& stages);
  /// h, or less: with its stages on the constraints a step turns no body by more than 0.5 rad.
  double longest(const State& y, double h) const;
  /// True when an attempt came near a singular position and must be repeated with its stages on the constraints.
  bool enters(const Stages&);
  /// Whether an attempt of this error should be moved rather than accepted or rejected.
  bool must_shift(const Stages&, int late_stage, double error) const;
  /// The step to attempt instead of h; after a dozen of them the best, with a larger limit of its error.
  double shift(const Stages&, int late_stage, double h, double error);
  /// Errors up to this are accepted.
  double limit() const { return limit_; }
  /// After acceptance: where the next step begins.
  void finish_step(const Stages&);

  /// First step from y; one that begins in a singular position leads out of it.
  double first_step(Dynamics&, const State& y, Stages&, double guess, double largest);
  bool near(const Stages& stages) const;

  void save(Snapshot& out) const { out.put(near_ ? 1 : 0); }
  void restore(const Snapshot& in) { near_ = in.get() != 0; }

 private:
  bool ill_conditioned(const Stages&, int stage) const;

  StagesWhen when_;
  const char* method_;
  double relative_ = 1e-6;  // tolerance
  SingularRate both_sides_;
  StateRate rate_;
  StagesOn on_ = StagesOn::plain;
  bool near_ = false;             // automatic: the next step begins with its stages on the constraints
  bool probed_ = false;           // whether the start of the run was probed for a singular position
  bool from_both_sides_ = false;  // the first stage's rates are SingularRate's
  int shifts_ = 0;                // of the present step,
  double limit_ = 1;
  struct {
    double h = 0, error = 0;
  } best_;  // and the best of them
};

}  // namespace lockstep
