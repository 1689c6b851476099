// SPDX-License-Identifier: BSD-3-Clause
// Evaluation of a mechanism, as integrators use it.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <lockstep/author/force.h>
#include <lockstep/author/passes.h>
#include <lockstep/author/solver.h>
#include <lockstep/body.h>
#include <lockstep/dynamics_options.h>

namespace lockstep {

// Evaluation: a mechanism at one state: motions of the bodies, rows of the joints, applied forces.

/// The inputs of a state, with the memory behind their motions. `s` and `z` are views of the state that was read.
class LOCKSTEP_API StateInputs {
 public:
  /// Reads this state: what joints and forces see of it. Valid until the next call, and while the state lives.
  const Inputs& at(const System&, const State&);
  /// The same, with motions and angles that `write` writes: motions of the ground and all slots, values of
  /// Inputs::angles and Inputs::angle_rates, whose sizes stay if there are none.
  template <class Write>
  const Inputs& at(const State& state, Write&& write) {
    look_at(state);
    write(motions_, in_, angles_, angle_rates_);
    in_.motions = motions_;
    return in_;
  }
  const Inputs& get() const { return in_; }  ///< those that at() read last

 private:
  void look_at(const State&);
  std::vector<Motion> motions_;
  std::vector<double> angles_, angle_rates_;
  Inputs in_;
};

class LoopSizes;

/// Rows and forces of a system, gathered at a state; neither solved nor factored (see Factor). Vectors have 6 numbers
/// per slot (rigid group of bodies), three in the world and three in slot axes (m/s and rad/s, or N and N m), or 1 per
/// row of rows().
class LOCKSTEP_API Evaluation {
 public:
  /// Gathers at this state; the system is set up if it was not. Throws what the code of joints and forces throws, with
  /// the name of the joint or force, and ModelError if the state does not fit the system.
  Evaluation(System&, const State&);
  /// Before at() or rows_at() it has no rows.
  explicit Evaluation(System& system) : system_(system) {}
  Evaluation(const Evaluation&) = delete;
  Evaluation& operator=(const Evaluation&) = delete;

  /// Gathers at another state. The rows are laid out again when the description or the active joints changed; otherwise
  /// nothing is allocated.
  void at(const State&);
  /// The same for the rows alone: no force is evaluated, and force() is zero.
  void rows_at(const State&);
  /// Throws NonFiniteError if a number is not finite, with the name of the joint or force that made it.
  void check() const;

  const System& system() const { return system_; }        ///< the system of these rows and forces
  const Inputs& inputs() const { return inputs_.get(); }  ///< what joints and forces saw
  const RowTable& rows() const { return rows_; }          ///< rows of the active joints
  /// Gravity, -w x J w and all applied forces except those that depend on reactions: 6 per slot, N (world) and N m
  /// (slot axes).
  const VecX& force() const { return f_; }

  /// C and Jh v + Ct, 1 per row.
  void residuals(VecX& C, VecX& Cd) const;
  /// Jh v + Ct, 1 per row, at the positions gathered and at these velocities. v: 6 per slot, m/s (world) and rad/s
  /// (slot axes).
  void velocity_residual(const VecX& v, VecX& Cd) const;
  /// The largest |c| over the rows as a length, m: lengths as they are, values of functions times System::length(),
  /// components of quaternions times twice that (framework/docs/solvers.md, section 1). NaN if one of them is.
  double norm(const VecX& c) const;
  /// Forces that depend on the present reactions (friction).
  const std::vector<const Force*>& reacting() const { return reacting_; }
  /// Adds these forces at the multipliers lambda, 1 per row, to f, 6 per slot.
  void react(const VecX& lambda, VecX& f) const;

  /// The layout. A factor of an equal layout serves this evaluation too.
  struct Layout {
    long revision = -1;                              ///< of the system
    std::vector<bool> modes;                         ///< active joints
    bool loops = false;                              ///< whether these close loops
    bool operator==(const Layout&) const = default;  ///< of the same setup and the same joints
  };
  const std::shared_ptr<const Layout>& layout() const { return layout_; }  ///< the present one
  const LoopSizes& loops() const { return *loops_; }                       ///< of it
  /// Whether at() would keep the layout at this state.
  bool covers(const State&) const;
  /// Kkt::redundant of these rows; unknown whenever they are laid out again.
  int redundant() const { return redundant_; }
  bool nearly() const { return nearly_; }  ///< Kkt::nearly
  /// Sets both, for factors of this evaluation.
  void set_redundant(int n, bool nearly = false) { redundant_ = n, nearly_ = nearly; }

 private:
  void lay_out(const State&);

  System& system_;
  std::shared_ptr<const Layout> layout_;
  std::shared_ptr<const LoopSizes> loops_;
  StateInputs inputs_;
  RowTable rows_;
  VecX f_;
  std::vector<const Force*> reacting_;
  int redundant_ = Kkt::kUnknown;
  bool nearly_ = false;
};

// KktAssembler: writes the gathered rows and the masses as the saddle-point matrix of a formulation.
//
// Formulation::omega       6 velocities per body, M = diag(m 1, J) constant, written once (2.9)
// Formulation::quaternion  the paper's 7 coordinates: M = diag(m 1, G^T J G), rows Jh G with Qhat (a consistent pair,
//                          2.13), one unit-length row per body (2.6). G^T J G is singular along q: k q q^T is added to
//                          it, and -k |qd|^2 q to the right-hand side; with the unit-length row the two cancel (2.7).

/// Writes rows and masses as the saddle-point matrix of a formulation.
class LOCKSTEP_API KktAssembler {
 public:
  /// Without a layout yet. The system must outlive it.
  KktAssembler(const System& system, Formulation formulation) : system_(system), formulation_(formulation) {}

  /// Lays out the shape; needed whenever the description or the active joints changed. `direct`: for a solver that
  /// reads the rows themselves; nothing is copied then, and load() and unload() are not needed. Throws ModelError for
  /// the quaternion formulation with `direct` or in a plane.
  void lay_out(const RowTable& rows, bool direct);
  /// For a solver that reads the rows: masses of 1 kg, inertias of 1 kg times the square of the length of the loop.
  void equal_masses(const LoopSizes&);
  void forget() { kkt_ = {}, masses_ = {}, n_links_ = 0; }      ///< gives back its memory: without a layout then
  bool direct() const { return kkt_.pattern.rows != nullptr; }  ///< laid out for a solver that reads the rows
  /// Writes the numbers: Jacobians, and the mass blocks if they depend on the pose. `motions`: ground, then slots.
  void update(const RowTable& rows, std::span<const Motion> motions);
  /// For a solver that reads the rows: the table that it reads from now on.
  void read(const RowTable& rows);
  void set_redundant(int n, bool nearly) { kkt_.redundant = n, kkt_.nearly = nearly; }  ///< sets these of Kkt
  const Kkt& kkt() const { return kkt_; }                                               ///< the matrix
  int n() const { return kkt_.pattern.n; }  ///< number of unknowns of the formulation
  int m() const { return kkt_.pattern.m; }  ///< number of its rows, those of unit length included

  /// Writes f6 (6 per slot: N, world; N m, slot axes) and c6 (1 per row of the table) as the right-hand side of the
  /// formulation, f (n) and c (m). `moving`: with the velocity-dependent terms that the formulation itself adds, for
  /// equations of motion; false for a projection.
  void load(const VecX& f6, const VecX& c6, std::span<const Motion> motions, bool moving, VecX& f, VecX& c) const;
  /// Writes the formulation's solution a (n) and lambda (m) as a6, 6 per slot (world; slot axes), and lambda6, 1 per
  /// row of the table.
  void unload(const VecX& a, const VecX& lambda, std::span<const Motion> motions, int n_rows, VecX& a6,
              VecX& lambda6) const;

 private:
  void lay_out_direct(const RowTable& rows);
  void write_mass(int slot, const Motion& O);

  const System& system_;
  Formulation formulation_;
  Kkt kkt_;
  std::vector<BodyMass> masses_;  // of slots, where the matrix is filled here
  int n_links_ = 0;               // of the table; unit-length rows follow them
};

// Factor: the saddle-point matrix of an evaluation, factored, and solutions by it.

/// Counters of work done, for reports and charts.
struct WorkCount {
  long evaluations = 0,  ///< of the equations of motion; in rattle and generalized_alpha, of rows and forces alone
      factors = 0,       ///< matrices factored
      projections = 0,   ///< projections of positions
      corrections = 0;   ///< proximal corrections of solutions
};

/// The factored saddle-point matrix of an evaluation, and solutions by it:
///
///     M a + Jh^T lambda = f     f, a: 6 per slot (world; slot axes); c, lambda: 1 per row of the table
///     Jh a - E lambda = c       E: proximal term, corrected away
///
/// The caller decides how long it is used. At the evaluation that it was computed from, solutions are exact. At a later
/// one with the same active joints the matrix is still the old one: M and the directions Jh^T of the constraint forces
/// are those of the old state (chord iterations, RATTLE).
class LOCKSTEP_API Factor {
 public:
  /// Without a matrix yet. The arguments must outlive it; factors and corrections are counted in `work`.
  Factor(const System&, const LinearSolver&, Formulation, WorkCount& work);

  /// Factors the matrix of this evaluation. Symbolic work is done only when the description or the active joints
  /// changed; otherwise nothing is allocated. Throws SolveError, and ModelError if solver and formulation do not go
  /// together.
  void compute(const Evaluation&);
  /// Solves for any right-hand side: projections, impulses, responses. `e`: the evaluation it was computed from, or a
  /// later one. Throws ModelError if `e` has other active joints than the matrix, or if nothing was computed.
  SolveReport solve(const Evaluation& e, const VecX& f, const VecX& c, VecX& a, VecX& lambda);
  /// Solves the equations of motion: as solve(), with the terms that the formulation adds to f and c, (2.4)-(2.6).
  SolveReport solve_motion(const Evaluation& e, const VecX& f, const VecX& c, VecX& a, VecX& lambda);
  /// Completes the report of the last solution, of this evaluation, by what costs time: residual, pivots, detector.
  void complete(const Evaluation&, SolveReport& report) const;
  /// Throws NonFiniteError if this solution is not finite, SolveError if its rows contradict one another, with
  /// the name of the joint or force.
  void check(const Evaluation&, const VecX& a, const VecX& lambda, const SolveReport&) const;
  /// Gives back the memory of the matrix.
  void forget();

 private:
  void lay_out(const Evaluation&);
  SolveReport solve(const Evaluation&, const VecX& f, const VecX& c, bool moving, VecX& a, VecX& lambda);
  static bool same(const std::shared_ptr<const Evaluation::Layout>& own, const Evaluation& e) {
    return own && (own == e.layout() || *own == *e.layout());
  }
  bool fits(const Evaluation& e) const { return same(layout_, e); }

  const LinearSolver* solver_;
  WorkCount* work_;
  KktAssembler assembler_;
  std::unique_ptr<KktAssembler> equal_;  // of equal bodies, for the detector where rows are redundant
  std::unique_ptr<Factorization> factorization_, of_equal_;
  std::shared_ptr<const Evaluation::Layout> layout_;  // null: no matrix yet
  VecX f_, c_, a_, lambda_;                           // in the formulation's own unknowns
};

// Projection: brings a state onto the constraints by the least move in the mass metric, positions, then velocities.

/// Constraint violations before and after a projection.
struct ProjectReport {
  double before = 0,      ///< |C| before, m
      after = 0;          ///< |C| after, m
  double before_v = 0,    ///< |Jh v + Ct| at the projected position, before the velocities are projected, m/s
      after_v = 0;        ///< |Jh v + Ct| after, m/s
  int rounds = 0;         ///< rounds of the positions
  bool converged = true;  ///< |C| is within the tolerance
};

/// Projects states onto the constraints, and holds the scratch for it: nothing is allocated when the active joints are
/// those of the last call.
class LOCKSTEP_API Projection {
 public:
  /// `tolerance`: |C| that a projection may leave, m.
  explicit Projection(double tolerance) : tolerance_(tolerance) {}

  /// M d + Jh^T z = 0, Jh d = -C, q <- q (+) d, until |C| <= `goal`, m, but not below round-off; then the velocities,
  /// to a tenth of it in m/s. A factor serves as long as a round removes nine tenths of |C| (chord). The report has not
  /// converged if more than the tolerance is left. Throws NonFiniteError, SolveError.
  ProjectReport project(Evaluation&, Factor&, State&, double goal);
  /// M dv + Jh^T z = 0, Jh dv = -(Jh v + Ct), until |Jh v + Ct| <= `goal`, m/s; gathers at the state. Returns what is
  /// left of it, m/s: more than round-off if rows contradict one another. Throws NonFiniteError, SolveError.
  double project_velocity(Evaluation&, Factor&, State&, double goal);

 private:
  bool positions(Evaluation&, Factor&, State&, double goal, ProjectReport&);
  double velocities(const Evaluation&, Factor&, bool factored, State&, double goal);

  double tolerance_;
  VecX C_, Cd_, d_, lambda_, zero_;
};

// ReactionIteration: solutions with forces that depend on reactions (friction).

/// Finds the accelerations if forces depend on the reactions (friction), and holds the scratch for it: nothing is
/// allocated if the mechanism is that of the last call.
class LOCKSTEP_API ReactionIteration {
 public:
  /// Finds a (6 per slot) and lambda (1 per row) with M a + Jh^T lambda = f + x, Jh a = c and
  /// x = Evaluation::react(lambda). On entry they are the solution without x by this factor, which computes all further
  /// ones too. Throws SolveError with the name of the force that does not converge, and NonFiniteError.
  void solve(const Evaluation&, Factor&, const VecX& c, VecX& a, VecX& lambda, SolveReport&);

 private:
  struct Unsettled {
    const Evaluation& e;
    Factor& factor;
    const VecX& c;
    VecX &a, &lambda;
    SolveReport& report;
  };
  void add(const Unsettled&, const VecX& load);
  [[noreturn]] void diagnose(const Unsettled&, double left);
  double last_gain(const Unsettled&);

  VecX added_, added_before_, change_, change_before_, loaded_;  // x, g(x) - x, the next x: 6 per slot
  VecX da_, dlambda_, no_rows_;                                  // what a change of x adds to a and lambda; zeros
};

// Redundancy: a function of the active joints and of the branch, found on assembled poses near a state.

/// How the rows of the active joints depend on one another in all assembled poses of a branch except singular ones.
struct Redundancy {
  int rows = Kkt::kUnknown;     ///< rows that depend on others (Kkt::redundant), by the rank of J
  bool nearly = false;          ///< some of them do so nearly, everywhere (Kkt::nearly)
  bool on_constraints = false;  ///< some do so in assembled poses only, as in the loops of Bennett and Bricard
  double regular = 1;           ///< the largest SolveReport::detector that was seen
};

// Dynamics: evaluates a mechanism for integrators: rates, projections, and factors of their own.

/// Accelerations and multipliers at one state, with the evaluation that they belong to. Views of a Dynamics, valid
/// until it evaluates or projects again.
struct Solution : Evaluated {
  const Evaluation& evaluation;  ///< rows and forces at this state
  const Factor& factor;          ///< the factored matrix of this state
  SolveReport report;            ///< without residual, pivots and detector, which cost time
  double uncertainty = 0;        ///< of Dynamics::solution_at: relative, of multipliers near a singular configuration

  /// The whole report: residual, pivots, detector.
  LOCKSTEP_API SolveReport full_report() const;
};

class SingularRate;

/// Evaluates a mechanism for integrators: rates, solutions, projections, factors. It holds one evaluation and one
/// factor, which every call uses again; with the default solver nothing is allocated while the active joints stay the
/// same.
class LOCKSTEP_API Dynamics {
 public:
  /// The system is set up if it was not, and must outlive this. Throws ModelError if there is no solver, if the
  /// stabilisation has a negative rate or a tolerance that is not above zero, and what System::setup throws.
  Dynamics(System&, std::unique_ptr<LinearSolver>, DynamicsOptions = {});
  ~Dynamics();
  Dynamics(const Dynamics&) = delete;
  Dynamics& operator=(const Dynamics&) = delete;

  const System& system() const { return system_; }  ///< the mechanism
  /// Sets the system up if its description changed.
  void set_up();
  /// As System::input().
  ControlInput& input(const std::string& name) { return system_.input(name); }
  std::deque<ControlInput>& control_inputs() { return system_.control_inputs(); }  ///< those of the system
  const DynamicsOptions& options() const { return options_; }                      ///< as given
  const LinearSolver& solver() const { return *solver_; }                          ///< as given
  WorkCount& work() { return work_; }                                              ///< counters of work done so far

  // -- at a state
  /// d/dt of q, v and s in the coordinates of the state, for integrators that support all formulations. Throws as
  /// rate().
  void rates(const State&, StateRate& out);
  /// The same, with the whole report of the solution: residual, pivots, detector.
  SolveReport rates_with_report(const State&, StateRate& out);
  /// Solves the equations of motion (2.1), (2.9) with the chosen stabilisation; `out`: d/dt of q, v and s, of a state in
  /// body coordinates. Throws NonFiniteError, SolveError.
  const Solution& rate(const State&, StateRate& out);
  /// Solves for the accelerations and multipliers alone. Throws NonFiniteError, SolveError.
  const Solution& evaluate(const State&);
  /// As evaluate(). Closer to a singular configuration than round-off allows, it gives limits from both sides instead
  /// (SingularRate); a multiplier without a limit, which grows as 1/distance, is NaN. Throws as evaluate().
  const Solution& solution_at(const State&);
  /// The accelerations of all slots, as in Evaluated: of an open chain by its recursion, else those of solution_at().
  /// Valid until the next call. Throws NonFiniteError, SolveError.
  const VecX& accelerations(const State&);
  /// Rows and forces, unsolved; valid until the next evaluation or projection. Throws NonFiniteError.
  const Evaluation& gather(const State&);
  /// Rows alone, without forces, which may be undefined for a state off the rows; otherwise as gather().
  const Evaluation& gather_rows(const State&);
  /// As System::InSpace of the mechanism.
  System::InSpace look_in_space() { return System::InSpace(system_); }
  /// What joints and forces see of this state, without rows; valid until the next call of this or of accept().
  const Inputs& inputs(const State&);
  long inputs_read() const { return n_inputs_; }  ///< counts those calls
  /// Whether rows of all joints are laid out, because they were gathered or evaluated.
  bool holds_rows() const { return evaluation_ != nullptr; }
  /// Frees the memory of the last evaluation, gather() and evaluate(), and of its factor, if the formulation has joint
  /// coordinates for the active joints at this state: then steps need rows of loop closures only. A later call lays
  /// them out again.
  void forget_rows(const State&);
  /// |C| over the rows in force, m (Evaluation::norm). Throws NonFiniteError.
  double violation(const State&);
  /// The same, in joint coordinates over the rows of loop closures alone, since joint coordinates satisfy the joints:
  /// rows of other joints are not laid out.
  double violation_of_closures(const State&);
  /// |Jh v + Ct| over the rows in force, m/s (Evaluation::norm). Throws NonFiniteError.
  double violation_v(const State&);

  // -- the coordinates of a state. All of the above except rate() takes a state in any coordinates.
  /// Converts the state to the coordinates of the formulation: with Formulation::joint and automatic to joint
  /// coordinates if they are possible (why_not_joint). `near`: angles are counted on from there; null: from zero.
  void to_formulation(State&, const State* near = nullptr);
  /// Converts the state to body coordinates, in which poses and twists can be set. Throws ModelError if the
  /// state does not fit the system.
  void to_slots(State&);
  /// The state in body coordinates; throws as to_slots().
  State in_slots(State state) {
    to_slots(state);
    return state;
  }
  /// Whether the state can be read as it is: a change of masses, joints or active joints makes other joint coordinates.
  bool has_current_coordinates(const State&);
  /// Why joint coordinates are not possible with these active joints; "" if they are. With Formulation::automatic also
  /// why they cost more.
  std::string why_not_joint(const std::vector<bool>& modes);

  // -- moving a state. In joint coordinates only loop closures are projected; an open chain has nothing to project.
  /// Moves the state onto C = 0, then onto Jh v = -Ct, by the least move in the mass metric, until |C| is a hundredth
  /// of the tolerance; quaternions are normalised first. Throws NonFiniteError, SolveError.
  ProjectReport project(State&);
  /// The same until |C| <= `goal`, m (not below round-off); it has converged if |C| is within the tolerance.
  ProjectReport project(State&, double goal);
  /// Projects the velocities only. Returns what is left of |Jh v + Ct|, m/s: more than round-off if rows contradict
  /// one another. Throws NonFiniteError, SolveError.
  double project_velocity(State&);
  // These throw ModelError if the state does not fit the system.
  /// q <- q (+) h v, with unit quaternions. h: s; v: 6 per slot, m/s (world) and rad/s (slot axes).
  void advance(State& state, double h, const VecX& v) const {
    system_.check_size(state);
    lockstep::advance_state(state, h, v);
  }
  /// Quaternions back to length one.
  void normalize(State& state) const {
    system_.check_size(state);
    lockstep::normalize_state(state);
  }
  /// After an accepted step: updates what joints and forces remember (State::z) and counted angles. Returns what they
  /// see of the state, as inputs() does; null if there is nothing to update.
  const Inputs* accept(State&);

  // -- redundant rows
  /// How the rows of the active joints depend on one another on the branch of this state, in its coordinates. Found
  /// once for these joints, at the first assembled state from which the mechanism moves, or at which no row depends on
  /// others. Unknown (rows < 0) before such a state.
  Redundancy redundancy(const State&);
  /// How many rows depend on others at this state, at least nearly, in its coordinates. Throws NonFiniteError.
  int dependent_rows(const State&);

  // -- matrices
  /// The factored matrix of this evaluation; valid until the next evaluation or projection. Throws SolveError.
  Factor& factor(const Evaluation&);
  // -- checkpoints
  void save(Snapshot&) const;     ///< writes the counters of work
  void restore(SnapshotReader&);  ///< takes back what save() wrote
  /// Writes a state in any coordinates; they must be current (has_current_coordinates).
  void save_state(const State&, Snapshot&) const;
  /// Reads what save_state() wrote. Throws ModelError if it does not fit the system.
  void load_state(State&, SnapshotReader&);

  /// A factor for the caller to keep, without a matrix yet. This Dynamics must outlive it.
  Factor new_factor() { return {system_, *solver_, kkt_formulation(), work_}; }

 private:
  struct Tree;

  void lay_out_reactions(Tree&) const;
  Formulation kkt_formulation() const {
    return options_.formulation == Formulation::quaternion ? Formulation::quaternion : Formulation::omega;
  }
  Evaluation& own();
  Evaluation& gathered(const State&);
  bool is_assembled(const State&);
  SolveReport pivots(const State&);
  Redundancy find_redundancy(const State&);
  Tree& tree(const std::vector<bool>& modes);
  void joint_rates(const State&, StateRate& out, SolveReport*);
  ProjectReport project_joint(State&, double goal);
  Tree* tree_of(const State&) const;
  const Inputs& read(const State&);
  void load_closures(Tree&);
  void joint_reactions(Tree&, const Inputs&);
  double joint_law_power(Tree&);
  const Solution* joint_accelerations(Tree&, const State&, const Inputs&, StateRate& out, SolveReport*);

  System& system_;
  std::unique_ptr<LinearSolver> solver_;
  DynamicsOptions options_;
  std::unique_ptr<Tree> tree_;  // joint coordinates; null until they are needed
  WorkCount work_;
  std::unique_ptr<Evaluation> evaluation_;  // null before the first state
  Factor factor_;
  Projection projection_;
  ReactionIteration reacting_;
  StateInputs inputs_;
  long n_inputs_ = 0;
  VecX a_, lambda_, c_, C_, Cd_;
  VecX asked_a_;  // by accelerations()
  std::optional<Solution> solution_;
  std::unique_ptr<SingularRate> both_sides_;              // of solution_at(); null before it was needed
  std::map<std::vector<bool>, Redundancy> redundancies_;  // by the active joints, and whether in joint coordinates
  long redundancies_of_ = -1;                             // revision of the system that they were found for
};

}  // namespace lockstep
