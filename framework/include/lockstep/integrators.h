// SPDX-License-Identifier: BSD-3-Clause
// The integrators.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <lockstep/author/integrator.h>
#include <lockstep/author/memory.h>
#include <lockstep/author/params.h>
#include <lockstep/author/stepping.h>
#include <lockstep/detail/newton.h>
#include <lockstep/dynamics.h>
#include <lockstep/math.h>
#include <lockstep/state.h>

namespace lockstep {

// Stiffness: whether damped fast modes, not the motion, limit the steps of an explicit method. After Hairer & Wanner,
// Solving Ordinary Differential Equations II (1996), IV.2.
//
// Two states of nearly one time, the end of a step and a stage at c = 1, differ most in the fastest mode, so
// |da|/|dv| is the rate |lambda| of that mode, and -da . dv / |dv|^2 the damped part of it. The motion is stiff if a
// damped mode keeps the steps at the limit of stability. An undamped oscillation must be followed by any method.

/// Detects that damped fast modes limit the steps of an explicit method.
class LOCKSTEP_API StiffnessWatch {
 public:
  /// `limit`: h |lambda| at the end of the method's interval of stability on the negative axis.
  explicit StiffnessWatch(double limit) : limit_(limit) {}
  void begin();  ///< forgets all steps
  /// Observes one accepted step of h, s. dv: the velocities at its end less those of a stage at c = 1; a_stage, a_end:
  /// the accelerations of that stage and of the end; all 6 per slot. Rotations count as lengths, times `length`, m.
  void observe(double h, const VecX& dv, const VecX& a_stage, const VecX& a_end, double length);
  /// The same by the sums |dv|^2, |da|^2 and da . dv over all bodies.
  void add(double h, double dv2, double da2, double da_dv);
  /// Whether damped fast modes limited the last window of 15 steps.
  bool stiff() const { return stiff_; }
  void save(Snapshot& out) const;    ///< saves the sums of the present window and stiff()
  void restore(SnapshotReader& in);  ///< takes back what save() wrote

 private:
  double limit_;
  double n_ = 0, rate2_ = 0, damped_ = 0;  // steps, and sums over them: (h |lambda|)^2, h times the damped part
  bool stiff_ = false;
};

// Embedded explicit Runge-Kutta: two results of different order from the same stages estimate the error, which chooses
// the step. What rk4, dopri5 and dop853 have in common; each has its own coefficients.

/// Options of an embedded method.
struct EmbeddedOptions {
  bool fixed = false;                         ///< steps of the requested length, without error control
  StagesWhen stages = StagesWhen::automatic;  ///< when stages are projected; automatic is plain if `fixed`

  LOCKSTEP_API static Keys keys();                          ///< its keys in scenes: "fixed", "stages"
  LOCKSTEP_API static EmbeddedOptions from(const Params&);  ///< from parameters checked against keys()
};

class SingularPassage;

/// Explicit Runge-Kutta method by an EmbeddedScheme: base of rk4, dopri5 and dop853. The projection moves the end of a
/// step, so that its last stage is not the first stage of the next one: every stage is evaluated. The same holds
/// without projection, since a host may change forces and inputs between two steps.
class LOCKSTEP_API EmbeddedRungeKutta : public AdaptiveStepper {
 public:
  ~EmbeddedRungeKutta() override;
  IntegratorInfo info() const override;
  void begin(Dynamics&, const State&) override;
  /// Nested polynomial in theta = (t - t0)/h. Stages that only it needs are evaluated at its first call in a step (by
  /// the Dynamics of begin(), which then holds the values of a stage). False for a scheme without an error estimate.
  bool dense(double t, State& out) const override;
  void set_tolerance(const Tolerance&) override;
  double first_step(Dynamics&, const State&, double largest) override;
  /// Its coefficients; null if the options request projected stages in every step, or fixed steps of a method with an
  /// estimate.
  const EmbeddedScheme* scheme() const override;
  void save(Snapshot&) const override;
  void restore(SnapshotReader&) override;

 protected:
  /// `scheme` lives as long as the program. Steps are fixed if it has no error estimate.
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
  std::unique_ptr<SingularPassage> passage_;
  StiffnessWatch watch_;
  Weights error_w_, second_w_, gap_w_;
  std::vector<Weights> dense_w_;
  Dynamics* dynamics_ = nullptr;
  StateRate error_, gap_;    // gap_: end of the last step less its late stage
  double h_ = 0;             // of the last step; 0: there is none
  double h_followed_ = 0;    // the same, for the watch, which a snapshot keeps
  double landed_t_ = 0;      // its end
  bool first_done_ = false;  // the first stage of the present step is evaluated

  mutable Stages stages_;  // dense() adds its stages in its first call
  mutable bool dense_ready_ = false;
  mutable std::vector<StateRate> poly_;
};

// dop853: Dormand and Prince's method of order 8 with error estimates of orders 5 and 3, dense output of order 7. The
// accurate choice.

/// dop853: explicit Runge-Kutta of order 8. 12 evaluations and one projection per step; 4 evaluations more in a step
/// with dense output.
class LOCKSTEP_API Dop853 final : public EmbeddedRungeKutta {
 public:
  static TypeInfo type_info();                             ///< its entry in the registry
  static std::unique_ptr<Integrator> make(const Params&);  ///< maker for the registry
  explicit Dop853(EmbeddedOptions options);                ///< with these options
  explicit Dop853(bool fixed = false);                     ///< `fixed`: without error control
};

// dopri5: Dormand and Prince's pair of orders 5(4), error-controlled, with dense output of order 4. The default.

/// dopri5: explicit Runge-Kutta of order 5. 7 evaluations and one projection per step.
class LOCKSTEP_API Dopri5 final : public EmbeddedRungeKutta {
 public:
  static TypeInfo type_info();                             ///< its entry in the registry
  static std::unique_ptr<Integrator> make(const Params&);  ///< maker for the registry
  explicit Dopri5(EmbeddedOptions options);                ///< with these options
  explicit Dopri5(bool fixed = false);                     ///< `fixed`: without error control
};

// FreeRotation: the torque-free rotation of a rigid body, split into rotations about its principal axes.
//
//   H = p1^2/(2 J1) + p2^2/(2 J2) + p3^2/(2 J3),   each part is an exact rotation:
//   p <- R_k(-a) p,   e <- e exp(a e_k),   a = p_k t/J_k
//
// composed as 1(t/2) 2(t/2) 3(t) 2(t/2) 1(t/2): symmetric, symplectic, of order 2; |p| and the angular momentum in
// space are kept exactly (Dullweber, Leimkuhler & McLachlan 1997).

/// The torque-free rotation of a rigid body by a symplectic splitting of order 2.
class LOCKSTEP_API FreeRotation {
 public:
  /// J: inertia about the centre of mass, in the axes of the body, kg m^2.
  explicit FreeRotation(const Mat3& J);
  /// Advances e (body axes in the world) and w (rad/s, body axes) by the time t, s, forward or back.
  void turn(double t, Quat& e, Vec3& w) const;

 private:
  void turn_about(int k, double t, Quat& e, Vec3& p) const;

  Quat axes_;  // principal axes in the body
  Vec3 J_;     // principal moments
};

// QuinticOutput: the motion inside a step from positions, velocities and accelerations at its two ends.
//
//   x, e: the polynomial of degree 5 that has p, p', p'' of both ends (e' = e w/2, e'' by (1.9)), e then normalised
//   v, w: its rate of change;   s: the polynomial of degree 3 that has s, s' of both ends
//
// Local error h^6 in positions, h^5 in velocities, h^4 in s. Implicit methods share it: the collocation polynomial of
// three stages has h^4 only.

/// Dense output of a step from values and two derivatives at both of its ends.
class LOCKSTEP_API QuinticOutput {
 public:
  /// Sizes everything and forgets the step; at() then gives this state.
  void begin(const State&);
  /// Sets a step from a to b (unit quaternions, at most 180 deg apart), with d/dt of v and s at both.
  void set(const State& a, const VecX& vd_a, const VecX& sd_a, const State& b, const VecX& vd_b, const VecX& sd_b);
  void forget() { h_ = 0; }  ///< forgets the step
  /// The state at t, s, with the memory and joints of the beginning. False if there is no step, except at its
  /// beginning.
  bool at(double t, State& out) const;

 private:
  State a_, b_;
  VecX vd_a_, vd_b_, sd_a_, sd_b_;
  double h_ = 0;  // 0: there is no step
};

// generalized_alpha: Chung and Hulbert's method on the Lie group, constraints at position and velocity level
// (stabilised index 2). One numerical damping for all motion that the step does not resolve.
//
//   q1 = q0 (+) ( h v0 + h^2 ((1/2 - beta) a0 + beta a1) + u ),   v1 = v0 + h ((1 - gamma) a0 + gamma a1)
//   (1 - alpha_m) a1 + alpha_m a0 = (1 - alpha_f) v1' + alpha_f v0'
//   M v1' + Jh^T lambda = f(q1, v1),   Jh v1 + Ct = 0,   C(q1) = 0
//
// (+) turns rotations by the exponential. u, of the size of the method's own error, brings positions onto C = 0 in the
// metric of Newton's matrix. a is the acceleration of the method, which differs slightly from v' at the same time.

/// generalized_alpha: implicit, order 2, with fixed steps unless it is adaptive. Each Newton iteration gathers once and
/// solves twice, by one factor per step if it converges fast. It starts from consistent accelerations; a step of
/// another length than the one before rescales a - v'.
class LOCKSTEP_API GeneralizedAlpha final : public AdaptiveStepper {
 public:
  static TypeInfo type_info();  ///< its entry in the registry
  /// Maker for the registry. Throws SceneError for a rho_infinity outside 0 ... 1.
  static std::unique_ptr<Integrator> make(const Params&);
  /// `rho_infinity`: share of an infinitely stiff mode that remains after a step, 0 (none) ... 1 (all). `adaptive`: it
  /// chooses its steps by the leading terms of its error in positions and velocities.
  explicit GeneralizedAlpha(double rho_infinity = 0.8, bool adaptive = false);

  IntegratorInfo info() const override;
  void begin(Dynamics&, const State&) override;
  bool dense(double t, State& out) const override { return output_.at(t, out); }
  void save(Snapshot& out) const override;
  void restore(SnapshotReader& in) override;

  double rho_infinity() const { return rho_; }    ///< as given
  const VecX& lambda() const { return lambda_; }  ///< multipliers at the end of the last step, 1 per row; order 2

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

// Increments: what a step adds to the state where it begins, as one vector, for the algebra of implicit methods.
//
//   y = (dx, D of every slot | dv, dw of every slot | ds),   x = x0 + dx, e = e0 exp(D/2), v = v0 + dv, s = s0 + ds
//
// D is the rotation vector since the beginning of the step, in slot axes. Its rate is
// (framework/docs/solvers.md, section 8; Iserles, Munthe-Kaas, Norsett & Zanna, Acta Numerica 9 (2000) 215)
//
//   D' = w + (D x w)/2 + k D x (D x w),   k = (1 - (a/2) cot(a/2))/a^2,   a = |D|

/// Number of increments of a state like this one: 12 per slot, then one per integrated state.
inline Eigen::Index n_increments(const State& y) { return 2 * y.v.size() + y.s.size(); }
/// out = start (+) y; time, memory and joints of `out` stay as they are.
LOCKSTEP_API void displace_state(const State& start, Eigen::Ref<const VecX> y, State& out);
/// out = d/dt of the increments y at the state `here` = start (+) y, at which the rates of the state are k.
LOCKSTEP_API void increment_rates(Eigen::Ref<const VecX> y, const State& here, const StateRate& k,
                                  Eigen::Ref<VecX> out);
/// out = the small increments y as the difference of two states near `at`, for ErrorNorm.
LOCKSTEP_API void as_difference(Eigen::Ref<const VecX> y, const State& at, StateRate& out);
/// Converts y, increments since the beginning of a step whose own increments are y1, into increments since its end.
/// `n_velocities`: 6 per slot.
LOCKSTEP_API void count_from(Eigen::Ref<const VecX> y1, Eigen::Index n_velocities, Eigen::Ref<VecX> y);
/// Largest rotation |D| of the increments, rad.
LOCKSTEP_API double largest_turn(Eigen::Ref<const VecX> y, Eigen::Index n_velocities);

// LinearizedMotion: y' = f(y) of the increments of a step, linearised at one state, and solved for implicit methods.
//
//   (g - f') dy = r:   g dq - dv = r_q,   g dv - al = r_v,   g ds = r_s,
//                      M al + D dv + K dq + Jh^T l = 0,   Jh al = 0
//
// K, D: tangents of forces and constraints (theory, section 9). The dependence of the rows' right-hand side on q and v
// is left out (9.15), as is that of states s and forces on the states s: Newton's method takes one iteration more.

/// Tangent of the motion at a state, for implicit methods.
class LOCKSTEP_API LinearizedMotion {
 public:
  using Complex = NewtonMatrix::Complex;  ///< a complex g
  /// Sizes the scratch for states like this one.
  void begin(const State&);
  /// Linearises at this solution. Throws what NewtonMatrix::gather throws.
  void gather(const Solution&);
  /// Factors g - f' for a real g, 1/s. Throws SolveError if it is singular.
  void factor(double g);
  /// Factors g - f' for a complex g; the real factor stays. Throws SolveError if it is singular.
  void factor(Complex g);
  /// y = (g - f')^-1 r by the real factor, which is that of this g. r, y: increments.
  void solve(double g, const VecX& r, VecX& y);
  /// The same by the complex factor: real and imaginary parts of r and y.
  void solve(Complex g, const VecX& r_re, const VecX& r_im, VecX& y_re, VecX& y_im);

 private:
  NewtonMatrix matrix_;
  VecX p_, p_im_, force_, force_im_, rows_, al_, l_;  // 6 per slot, 1 per row
  VecXc force_c_, rows_c_, al_c_, l_c_;
};

// Step control of implicit Runge-Kutta methods: Hairer & Wanner, Solving Ordinary Differential Equations II (1996),
// IV.8; prediction by K. Gustafsson, ACM Trans. Math. Softw. 20 (1994) 496.

/// Predictive step control (Gustafsson 1994) for an error estimate of the order of h^4. A step that took many
/// iterations is followed by a shorter one; safety 0.9, factors 0.2 ... 5, no growth after a rejection.
class LOCKSTEP_API PredictiveControl final : public StepControl {
 public:
  void begin() override { h_ = 0; }
  double accept(double h, double error, int iterations, bool after_rejection) override;
  double reject(double error, int iterations) const override;
  void save(Snapshot& out) const override { out.put(h_), out.put(error_); }
  void restore(SnapshotReader& in) override { h_ = in.get(), error_ = in.get(); }

  static constexpr int kMostIterations = 10;  ///< of Newton's method in one attempt

 private:
  double h_ = 0, error_ = 0;  // of the step accepted before; 0: none
};

// radau5: RADAU IIA with three stages, order 5, implicit: for stiff mechanisms with high accuracy.
//
//   Z_i = h sum_j a_ij f(t + c_j h, y0 + Z_j),   y1 = y0 + Z_3
//
// y = (q, v, s) are increments since the beginning of the step, f the equations of motion solved for the accelerations
// (index 1, stabilised by the options of the dynamics); the end of a step is projected like that of an explicit method.
// Positions, velocities and reactions have order 5.

/// radau5: implicit Runge-Kutta of order 5. Simplified Newton with one real and one complex factor per attempt
/// (tangents of forces and constraints at its second stage; the curvature of the rows is left out, which costs an
/// iteration). Error estimate of order 3 by one more solution, predictive step control (Gustafsson 1994), dense output
/// by QuinticOutput.
class LOCKSTEP_API Radau5 final : public AdaptiveStepper {
 public:
  static TypeInfo type_info();                             ///< its entry in the registry
  static std::unique_ptr<Integrator> make(const Params&);  ///< maker for the registry
  explicit Radau5(bool fixed = false);                     ///< `fixed`: without error control

  IntegratorInfo info() const override;
  void begin(Dynamics&, const State&) override;
  bool dense(double t, State& out) const override { return output_.at(t, out); }
  /// Errors of several tolerances per step are accepted, so that the error of a run follows the tolerance.
  void set_tolerance(const Tolerance&) final;
  void save(Snapshot& out) const override;
  void restore(SnapshotReader& in) override;

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

// rattle2, rattle4: symplectic and reversible on the constraints, for the energy of long runs (Andersen 1983).
//
//   p' = p + h/2 f(q0) - J(q0)^T mu,   q1 = drift(h, q0, p') with C(q1) = 0
//   p1 = p' + h/2 f(q1) - J(q1)^T nu   with J(q1) M^-1 p1 = -Ct
//
// Order 2; order 4 composed of five (Suzuki 1990). Bodies rotate freely in the drift (FreeRotation).

struct RattleScheme;

/// rattle2, rattle4: symplectic, with fixed steps, for long runs: the energy oscillates about its value at the start
/// and does not drift. A substep costs one factor and 3 to 5 evaluations of the constraints. Quadratures (State::s)
/// follow the trapezoidal rule over each substep, with one evaluation per substep, and have the order of the method. No
/// error estimate, no dense output.
///
/// begin() throws ModelError for forces that depend on velocities or reactions and for integrated states that act on
/// the mechanism. step() throws StepError if the multipliers do not converge, as in singular configurations.
class LOCKSTEP_API Rattle final : public Integrator {
 public:
  static TypeInfo type_info(int order);                ///< its entry in the registry; `order`: 2 or 4
  static std::unique_ptr<Integrator> make(int order);  ///< maker for the registry; `order`: 2 or 4
  /// `order`: 2 or 4.
  explicit Rattle(int order);

  IntegratorInfo info() const override;
  void begin(Dynamics&, const State&) override;
  StepReport step(Dynamics&, State&, double h) override;
  void save(Snapshot&) const override;
  void restore(SnapshotReader&) override;

 private:
  struct Turning {
    int slot;
    FreeRotation rotation;
  };
  void refuse_unsuited(Dynamics&, const State&) const;
  void substep(Dynamics&, double h);
  const Evaluation& find_multipliers(Dynamics&, double h, double t);
  void drift(double h);
  void factor_again(Dynamics&);
  const Evaluation& gather_next(Dynamics&);
  void kick(const Evaluation&, double h);
  bool goes_on_from(const State&) const;
  [[noreturn]] void fail(double h, double left) const;

  const RattleScheme& scheme_;
  std::vector<Turning> turning_;
  State now_, next_;     // before and after a drift
  VecX v_half_, guess_;  // velocities of the drift; the change of velocity of the last kick per second
  VecX C_, Cd_, f_, d_, lambda_;
  StateRate rate0_, rate1_;
  std::optional<Factor> factor_;  // of the matrix at now_ once a kick was made
  double left_ = 0;               // |C| at now_, m
  bool ready_ = false;            // factor_ and guess_ are those of now_
  VecX factored_q_;               // where the matrix was factored: q of now_ before it was normalised,
  double factored_t_ = 0;         // and the time
  bool restored_ = false;         // the matrix at that state is not factored yet
};

// rk4: the classical Runge-Kutta method of order 4 with a fixed step, for teaching and comparison.

/// rk4: explicit Runge-Kutta of order 4 with fixed steps. 4 evaluations and one projection per step. No error estimate,
/// no dense output.
class LOCKSTEP_API Rk4 final : public EmbeddedRungeKutta {
 public:
  static TypeInfo type_info();  ///< its entry in the registry; it has no keys
  Rk4();
};

// semi_implicit_euler: velocities first, then positions with the new velocities. The method of games and real time.
//
//   v1 = v + h a(t, q, v),  q1 = q (+) h v1 (exponential),  s1 = s + h s'(t, q, v)

/// semi_implicit_euler: order 1, with fixed steps. 1 evaluation and one projection per step. No error estimate, no
/// dense output.
class LOCKSTEP_API SemiImplicitEuler final : public AdaptiveStepper {
 public:
  static TypeInfo type_info();  ///< its entry in the registry; it has no keys
  SemiImplicitEuler() : AdaptiveStepper(1, nullptr) {}

  IntegratorInfo info() const override;
  void begin(Dynamics&, const State&) override;

 private:
  double start_step(Dynamics&, double h) override;
  Attempt attempt(Dynamics&, double h) override;

  StateRate rate_;
};

}  // namespace lockstep
