// Evaluation of a mechanism: what an integrator may ask.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <lockstep/body.h>
#include <lockstep/solver.h>
#include <lockstep/system.h>

namespace lockstep {

// Evaluation: a mechanism at one state: motions of the bodies, rows of the links, applied forces.


/// Inputs together with the memory behind them. `s` and `z` are views of the state that was read.
class LOCKSTEP_API StateInputs {
 public:
  /// What links and forces see of this state; valid until the next call.
  const Inputs& at(const System&, const State&);
  const Inputs& get() const { return in_; }

 private:
  std::vector<Motion> motions_;
  Inputs in_;
};

/// Rows and forces, gathered at a state: there is none without. Neither solved nor factored (Factor). Vectors have 6
/// numbers per slot (m and rad, or N in the world and N m in slot axes) or 1 per row of rows().
class LOCKSTEP_API Evaluation {
 public:
  /// Gathers at this state; the system is set up if it was not. Throws what the code of links and forces throws, named,
  /// and ModelError where the state does not fit the system.
  Evaluation(System&, const State&);
  Evaluation(const Evaluation&) = delete;
  Evaluation& operator=(const Evaluation&) = delete;

  /// The same at another state. Lays out anew when the description or the links in force changed; otherwise nothing is
  /// allocated.
  void at(const State&);
  /// Throws NonFiniteError that names who made a number that is not finite.
  void check() const;

  const System& system() const { return system_; }
  const Inputs& inputs() const { return inputs_.get(); }
  const RowTable& rows() const { return rows_; }
  /// Gravity, -w x J w and all applied forces but what depends on reactions.
  const VecX& force() const { return f_; }

  /// C and Jh v + Ct, 1 per row.
  void residuals(VecX& C, VecX& Cd) const;
  /// Jh v + Ct at other velocities than the state's: the positions are those gathered. v: 6 per slot.
  void velocity_residual(const VecX& v, VecX& Cd) const;
  /// The largest |c| as a length (framework/docs/solvers.md): metres, radians times System::length(), half turns times twice that.
  /// NaN if one is.
  double norm(const VecX& c) const;

  /// Forces that depend on the present reactions (friction), and what they add to f at these multipliers.
  const std::vector<const Force*>& reacting() const { return reacting_; }
  void react(const VecX& lambda, VecX& f) const;

  /// What was laid out: a factor of the same layout serves this evaluation too.
  struct Layout {
    long revision = -1;       ///< of the system
    std::vector<bool> modes;  ///< links in force
    bool operator==(const Layout&) const = default;
  };
  const std::shared_ptr<const Layout>& layout() const { return layout_; }
  /// Whether at() would lay out nothing anew.
  bool covers(const State&) const;

 private:
  void lay_out(const State&);

  System& system_;
  std::shared_ptr<const Layout> layout_;
  StateInputs inputs_;
  RowTable rows_;
  VecX f_;
  std::vector<const Force*> reacting_;
};


// How drift off the constraints is fought.


/// How drift off the constraints is removed.
struct Stabilization {
  enum class Kind { project, baumgarte, none };
  Kind kind = Kind::project;
  double alpha = 5, beta = 5;  ///< Baumgarte's rates, 1/s: Cdd + 2 alpha Cd + beta^2 C = 0 (2.15)
  double tolerance = 1e-10;    ///< of |C| in metres (radians times the scene's length), for projection and assembly
};

/// Which unknowns the equations of motion have: 6 velocities a body, or the paper's 7 coordinates with unit-length
/// rows.
enum class Formulation { omega, quaternion };


// KktAssembler: writes the gathered rows and the masses as the saddle-point matrix of a formulation.
//
// Formulation::omega       6 velocities per body, M = diag(m 1, J) constant, written once (2.9)
// Formulation::quaternion  the paper's 7 coordinates: M = diag(m 1, G^T J G), rows Jh G with Qhat (a consistent pair,
//                          2.13), one unit-length row per body (2.6). G^T J G is singular along q; k q q^T is added to
//                          it and -k |qd|^2 q to the right side, which the unit-length row makes void (2.7).


/// Writes rows and masses as the saddle-point matrix of a formulation.
class LOCKSTEP_API KktAssembler {
 public:
  KktAssembler(const System& system, Formulation formulation) : system_(system), formulation_(formulation) {}

  /// Shape, when the set of active links changed. `direct`: for a solver that reads the rows themselves; nothing is
  /// copied then, and load and unload are not needed. Throws ModelError where the formulation cannot be had.
  void lay_out(const RowTable& rows, bool direct);
  bool direct() const { return kkt_.pattern.rows != nullptr; }
  /// Numbers: jacobians, and the mass blocks where they move. `motions`: ground, then slots.
  void update(const RowTable& rows, std::span<const Motion> motions);
  /// For a direct solver: where the rows are read from now on.
  void read(const RowTable& rows);
  const Kkt& kkt() const { return kkt_; }
  int n() const { return kkt_.pattern.n; }  ///< unknowns of the formulation
  int m() const { return kkt_.pattern.m; }  ///< its rows, those of unit length included

  /// f (6 per slot: N, world; N m, slot axes) and c (1 per row of the table) as the formulation's own right side.
  /// `moving`: the accelerations of the unit-length rows and of the mass matrix are wanted too (equations of motion, not
  /// a projection).
  void load(const VecX& f6, const VecX& c6, std::span<const Motion> motions, bool moving, VecX& f, VecX& c) const;
  /// The formulation's solution as 6 per slot and one multiplier per row of the table.
  void unload(const VecX& a, const VecX& lambda, std::span<const Motion> motions, int n_rows, VecX& a6,
              VecX& lambda6) const;

 private:
  void lay_out_direct(const RowTable& rows);
  void write_mass(int slot, const Motion& O);

  const System& system_;
  Formulation formulation_;
  Kkt kkt_;
  std::vector<BodyMass> masses_;  // of slots, where the matrix is filled here
  int n_links_ = 0;  // of the table; unit-length rows follow them
};


// Factor: the saddle-point matrix of an evaluation, factored, and solutions by it.


/// Counters of work done, for reports and charts.
struct WorkCount {
  long evaluations = 0, factors = 0, projections = 0, corrections = 0;
};

///   | M   Jh^T | | a      |   | f |     f, a: 6 per slot (world; slot axes); c, lambda: 1 per row of the table
///   | Jh  -E   | | lambda | = | c |     E: proximal term, corrected away
///
/// Whoever holds one decides how long it serves. At the evaluation that it was computed from, solutions are exact. At
/// a later one with the same links in force the matrix is still the old one: M, and the directions Jh^T of the forces
/// are those of the old state (chord iterations, RATTLE).
class LOCKSTEP_API Factor {
 public:
  /// No matrix yet. All must outlive it; factors and corrections are counted in `work`.
  Factor(const System&, const LinearSolver&, Formulation, WorkCount& work);

  /// Factors the matrix of this evaluation. Symbolic work only when the description or the links in force changed;
  /// otherwise nothing is allocated. Throws SolveError.
  void compute(const Evaluation&);
  /// Any right side: projections, impulses, responses. `e`: computed from, or later. Throws ModelError where `e` has
  /// other links in force than the matrix, or nothing was computed.
  SolveReport solve(const Evaluation& e, const VecX& f, const VecX& c, VecX& a, VecX& lambda);
  /// The equations of motion: as solve(), and with what the formulation itself adds to f and c, (2.4)-(2.6).
  SolveReport solve_motion(const Evaluation& e, const VecX& f, const VecX& c, VecX& a, VecX& lambda);
  /// Fills what the report of the last solution leaves out since it costs time: residual, pivots, detector.
  void complete(SolveReport& report) const { factorization_->complete(report); }
  /// Throws NonFiniteError and SolveError, by name, when this solution is not finite or its rows contradict one another.
  void check(const Evaluation&, const VecX& a, const VecX& lambda, const SolveReport&) const;

 private:
  void lay_out(const Evaluation&);
  SolveReport solve(const Evaluation&, const VecX& f, const VecX& c, bool moving, VecX& a, VecX& lambda);
  bool fits(const Evaluation& e) const { return layout_ && (layout_ == e.layout() || *layout_ == *e.layout()); }

  const LinearSolver* solver_;
  WorkCount* work_;
  KktAssembler assembler_;
  std::unique_ptr<Factorization> factorization_;
  std::shared_ptr<const Evaluation::Layout> layout_;  // null: no matrix yet
  VecX f_, c_, a_, lambda_;  // in the formulation's own unknowns
};


// Projection: brings a state onto the constraints by the least move in the mass metric, positions, then velocities.


/// What a projection found and what it left.
struct ProjectReport {
  double before = 0, after = 0;      ///< |C|, metres
  double before_v = 0, after_v = 0;  ///< |Jh v + Ct|, m/s
  int rounds = 0;
  bool converged = true;
};

/// Scratch for the iterations; nothing is allocated when the links in force are those of the last call.
class LOCKSTEP_API Projection {
 public:
  /// `tolerance`: of |C|, m.
  explicit Projection(double tolerance) : tolerance_(tolerance) {}

  /// M d + Jh^T z = 0, Jh d = -C, q <- q (+) d, until |C| <= `goal`, m, but not below round-off; then the velocities to
  /// a tenth of it, m/s. A factor serves as long as a round takes nine tenths of |C| away (chord). The report says that
  /// it did not converge when more than the tolerance is left. Throws NonFiniteError, SolveError.
  ProjectReport project(Evaluation&, Factor&, State&, double goal);
  /// M dv + Jh^T z = 0, Jh dv = -(Jh v + Ct), until |Jh v + Ct| <= `goal`, m/s; gathers at the state. What is left of it:
  /// more than round-off where rows contradict one another.
  double project_velocity(Evaluation&, Factor&, State&, double goal);

 private:
  bool positions(Evaluation&, Factor&, State&, double goal, ProjectReport&);
  double velocities(const Evaluation&, Factor&, bool factored, State&, double goal);

  double tolerance_;
  VecX C_, Cd_, d_, lambda_, zero_;
};


// ReactionIteration: solutions with forces that depend on the reactions that they cause (friction).


/// Scratch for the search; nothing is allocated when the mechanism is that of the last call.
class LOCKSTEP_API ReactionIteration {
 public:
  /// a and lambda solve M a + Jh^T lambda = f + x, Jh a = c, x = Evaluation::react(lambda). They come in solved without
  /// x, by this factor; all solutions are made by it. Throws SolveError naming the force that does not settle, and
  /// NonFiniteError.
  void solve(const Evaluation&, Factor&, const VecX& c, VecX& a, VecX& lambda, SolveReport&);

 private:
  struct Unsettled {
    const Evaluation& e;
    Factor& factor;
    const VecX& c;
    VecX &a, &lambda;
    SolveReport& report;
  };
  [[noreturn]] void diagnose(const Unsettled&, double left);

  VecX added_, added_before_, change_, change_before_, loaded_;  // x, g(x) - x, f + x: 6 per slot
};


// Dynamics: what an integrator asks of a mechanism: rates, projections, and matrices of its own.


/// Formulation and stabilisation.
struct DynamicsOptions {
  Formulation formulation = Formulation::omega;
  Stabilization stabilization;
};

/// Accelerations and multipliers at one state, with the evaluation that they belong to. Views of a Dynamics, valid
/// until that evaluates or projects again.
struct Solution : Evaluated {
  const Evaluation& evaluation;
  const Factor& factor;
  SolveReport report;  ///< without what costs time to know

  /// The whole report: residual, pivots, detector.
  SolveReport full_report() const;
};

/// What an integrator may ask of a mechanism: rates, solutions, projections.
class LOCKSTEP_API Dynamics {
 public:
  /// The system is set up if it was not. The solver must not be null.
  Dynamics(System&, std::unique_ptr<LinearSolver>, DynamicsOptions = {});
  Dynamics(const Dynamics&) = delete;
  Dynamics& operator=(const Dynamics&) = delete;

  const System& system() const { return system_; }
  /// Sets the system up when its description changed.
  void set_up() { system_.setup(); }
  const DynamicsOptions& options() const { return options_; }
  const LinearSolver& solver() const { return *solver_; }
  WorkCount& work() { return work_; }

  // -- at a state
  /// (2.1), (2.9) with the chosen stabilisation: d/dt of q, v and s. Throws NonFiniteError, SolveError.
  const Solution& rate(const State&, StateRate& out);
  /// The accelerations and multipliers alone.
  const Solution& evaluate(const State&);
  /// Rows and forces, unsolved; valid until the next evaluation or projection. Throws NonFiniteError.
  const Evaluation& gather(const State&);
  /// What links and forces see of this state, without rows; valid until the next call.
  const Inputs& inputs(const State&);
  /// |C|, m, and |Jh v + Ct|, m/s, over the rows in force (Evaluation::norm).
  double violation(const State&);
  double violation_v(const State&);

  // -- moving a state
  /// The least move in the mass metric onto C = 0, then onto Jh v = -Ct; quaternions normalised first.
  ProjectReport project(State&);
  /// The same until |C| <= `goal`, m (not below round-off): what is left at most is still the tolerance.
  ProjectReport project(State&, double goal);
  /// Only the velocities; what is left of |Jh v + Ct|, m/s: more than round-off where rows contradict one another.
  double project_velocity(State&);
  /// q (+) h v on the unit sphere. v: 6 per slot, m/s (world) and rad/s (slot axes).
  void advance(State& state, double h, const VecX& v) const { lockstep::advance(state, h, v); }
  void normalize(State& state) const { lockstep::normalize(state); }
  /// After an accepted step: what links and forces remember (State::z).
  void accept(State&);

  // -- matrices
  /// The matrix of this evaluation, factored; valid until the next evaluation or projection.
  Factor& factor(const Evaluation&);
  /// One for the caller to keep, without a matrix yet. This Dynamics must outlive it.
  Factor new_factor() { return {system_, *solver_, options_.formulation, work_}; }

 private:
  Evaluation& own(const State&);
  Evaluation& gathered(const State&);

  System& system_;
  std::unique_ptr<LinearSolver> solver_;
  DynamicsOptions options_;
  WorkCount work_;
  std::unique_ptr<Evaluation> evaluation_;  // null before the first state
  Factor factor_;
  Projection projection_;
  ReactionIteration reacting_;
  StateInputs inputs_;
  VecX a_, lambda_, c_, C_, Cd_;
  std::optional<Solution> solution_;
};

}  // namespace lockstep
