// SPDX-License-Identifier: BSD-3-Clause
// Work-precision data: the cost of accuracy. Each combination of integrator, formulation, stabilisation and solver runs
// at a sequence of tolerances or steps, coarsest first; each run is compared to a reference over its history.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/step_loop.h>

namespace lockstep {

class EnergyAudit;

/// A mechanism ready to start. `owner` keeps the system, the events, the observers and the audit alive.
struct Subject {
  std::shared_ptr<void> owner;
  System* system = nullptr;
  State start;  ///< assembled
  std::vector<Event> events{};
  std::vector<Observer*> observers{};  ///< those that the events' conditions need
  EnergyAudit* audit = nullptr;        ///< its verdict is that of the run; null: no run is wrong
};

/// The motion that is measured: `length` seconds from the start, which every call of `make` returns anew, compared at
/// `outputs` evenly spaced times (a fixed step is an integer fraction of their interval).
struct Trajectory {
  std::function<Subject()> make;
  double length = 0;  ///< s
  int outputs = 100;
  std::function<Subject()> truth{};  ///< the same mechanism for the reference, if it differs from `make`
};

struct MethodChoice {
  std::string name;
  std::function<std::unique_ptr<Integrator>()> make;
};
struct SolverChoice {
  std::string name;
  std::function<std::unique_ptr<LinearSolver>()> make;
};

enum class ErrorKind { position, velocity, energy, reaction };
inline constexpr std::array<ErrorKind, 4> kErrorKinds{ErrorKind::position, ErrorKind::velocity, ErrorKind::energy,
                                                      ErrorKind::reaction};

/// Largest over the history and over the bodies.
struct HistoryError {
  double position = 0;  ///< m: of the centre of mass, and of the rotation (rad) times the system's length
  double velocity = 0;  ///< m/s, alike
  double energy = 0;    ///< J, of kinetic plus potential energy
  double reaction = 0;  ///< N: of the total load of all joints on a body, force and moment/length; unique even with
                        ///< redundant constraints
  LOCKSTEP_API double of(ErrorKind) const;
  bool operator==(const HistoryError&) const = default;
};

struct WorkPrecisionRun {
  std::string integrator, solver;
  Formulation formulation = Formulation::omega;
  Stabilization::Kind stabilization = Stabilization::Kind::project;
  bool adaptive = false;
  double setting = 0;  ///< relative tolerance, or step in s
  HistoryError error{};
  double cpu = 0;  ///< s of this thread, the least of the repeats, without the outputs of the comparison
  long evaluations = 0, factors = 0, steps = 0, rejected = 0;
  std::string failure{};                       ///< the reason of a missing result; "" if there is one
  bool given_up = false, interrupted = false;  ///< its time was used up; the user interrupted it
  bool wrong = false;                          ///< complete, but wrong by Audit::is_wrong()
  Formulation used = formulation;              ///< that which automatic chose, of a complete run
  bool done() const { return failure.empty(); }
};

/// Whether the unknowns are joint coordinates: no linear solver is chosen. `automatic`: if it uses joint coordinates.
inline bool needs_no_solver(Formulation f) { return f == Formulation::joint || f == Formulation::automatic; }

/// The first items of the lists are the base. All combinations are measured, or those that differ from it in one item.
struct WorkPrecisionOptions {
  std::vector<MethodChoice> integrators;
  std::vector<SolverChoice> solvers;
  /// With joint coordinates, also those of `auto`, only the first solver runs, and without `loops` only the first
  /// stabilisation: there are no constraints.
  std::vector<Formulation> formulations{Formulation::omega, Formulation::quaternion};
  std::vector<Stabilization::Kind> stabilizations{Stabilization::Kind::project, Stabilization::Kind::baumgarte,
                                                  Stabilization::Kind::none};
  bool loops = false;       ///< joint coordinates have loop-closure constraints, and these are stabilised
  bool separately = false;  ///< one item at a time
  Stabilization gains;      ///< Baumgarte's rates and the projection's tolerance
  std::vector<double> tolerances{1,    1e-1, 1e-2, 1e-3,  1e-4,  1e-5, 1e-6,
                                 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12};  ///< falling; atol_x is 1e-2 of each
  std::vector<int> steps{1,   2,   4,    8,    16,   32,   64,   128,
                         256, 512, 1024, 2048, 4096, 8192, 16384};  ///< fixed steps in an output interval, rising
  double largest_step = 0;                                          ///< of adaptive methods, s; 0: no limit

  /// Adaptive methods, the most promising first; the two of different kinds (names up to ":") that agree best are used.
  std::vector<MethodChoice> references;
  double reference_tolerance = 1e-13;  ///< up to 1000 times wider if it cannot be met
  double budget = 60;                  ///< s of CPU time; combinations that do not fit are listed in left_out
  int repeats = 3;                     ///< of runs below `quick`; the least time counts
  double quick = 0.02;                 ///< s
  /// Relative error of a first hit. Until each integrator in the base's form has one, the others wait, for half of the
  /// budget at most; with a target, until each has met it.
  double first_hit = 1e-3;
  double hopeless = 100;  ///< a combination ends if it costs this many times another of the same error

  ErrorKind target_kind = ErrorKind::position;
  double target = 0;  ///< above 0: a combination ends if two runs met this error, or if it cannot be the cheapest

  std::function<double()> clock{};  ///< s, of the budget; infinite: the user interrupts; default: thread_seconds
  std::function<double()> cpu{};                            ///< s; default: thread_seconds
  std::function<void(const std::string&)> progress{};       ///< called before every run
  std::function<void(const WorkPrecisionRun&)> measured{};  ///< called after every run
};

struct WorkPrecision {
  std::vector<WorkPrecisionRun> runs;  ///< of one combination: from coarse to fine
  struct Unsuited {
    std::string what, why;
    int n = 1;
  };
  std::vector<Unsuited> unsuited{};      ///< reasons why n combinations, such as `what`, cannot run this mechanism
  std::vector<std::string> left_out{};   ///< runs that the budget did not reach
  std::vector<WorkPrecisionRun> open{};  ///< the same runs, by their settings: nothing is known of them
  /// Combinations that ended at their finest setting, or as too expensive, while their error still fell; without settings.
  std::vector<WorkPrecisionRun> falling{};
  std::string reference, second;  ///< "dop853 at 1e-13"
  HistoryError agreement;         ///< of the two references: smaller errors are meaningless
  HistoryError size;  ///< largest displacement, speed, kinetic energy (or its change) and joint load: scale of errors
};

/// Cheapest next run first, until all combinations have ended or the budget is spent. Of combinations that
/// compute the same, as keys of an integrator without effect do, the first is kept. Throws StepError if there is no
/// reference and ModelError for an empty trajectory or empty options; every other failure is a result.
LOCKSTEP_API WorkPrecision work_precision(const Trajectory&, const WorkPrecisionOptions&);

/// True if all but the setting is equal.
LOCKSTEP_API bool same_way(const WorkPrecisionRun&, const WorkPrecisionRun&);
/// "dopri5" of "dopri5:stages=manifold".
LOCKSTEP_API std::string integrator_type(const std::string& integrator);

LOCKSTEP_API std::string to_string(Stabilization::Kind);
LOCKSTEP_API std::string to_string(ErrorKind);
LOCKSTEP_API const char* unit_of(ErrorKind);  ///< "m", "m/s", "J", "N"
/// "dop853, omega, project, sparse"; "dop853, joint, project".
std::string way_of(const WorkPrecisionRun&);
/// "dop853, omega, project, sparse, tolerance 1e-06".
LOCKSTEP_API std::string label(const WorkPrecisionRun&);

/// CPU time of the calling thread, s.
LOCKSTEP_API double thread_seconds();

}  // namespace lockstep
