// Work against precision: what accuracy costs. Every given combination of integrator, formulation, stabilisation and
// solver climbs a ladder of tolerances or steps, coarsest first; each run is held against a reference over its history.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/step_loop.h>

namespace lockstep {

/// A mechanism ready to start. `owner` keeps alive whatever the system, the events and the observers stand in.
struct Subject {
  std::shared_ptr<void> owner;
  System* system = nullptr;
  State start;  ///< assembled
  std::vector<Event> events{};
  std::vector<Observer*> observers{};  ///< those that the events' conditions need
};

/// What is charted: equal starts, one a call; from the start for `length` seconds, compared at `outputs` evenly spaced
/// instants (a fixed step is a whole part of their interval, so that landing on them costs nothing).
struct Trajectory {
  std::function<Subject()> make;
  double length = 0;  ///< s
  int outputs = 100;
  std::function<Subject()> truth{};  ///< the same mechanism for the reference, when `make` builds it by other means
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
  double position = 0;  ///< m: of the mass centre, and of the turn (rad) times the system's length
  double velocity = 0;  ///< m/s, alike
  double energy = 0;    ///< J, of kinetic and potential energy together
  double reaction = 0;  ///< N: all that links put on a body, force and moment by the length; one value, rows redundant
                        ///< or not
  LOCKSTEP_API double of(ErrorKind) const;
};

struct WorkPrecisionRun {
  std::string integrator, solver;
  Formulation formulation = Formulation::omega;
  Stabilization::Kind stabilization = Stabilization::Kind::project;
  bool adaptive = false;
  double setting = 0;  ///< relative tolerance, or step in s
  HistoryError error{};
  double cpu = 0;  ///< s of this thread, the least of the repeats; without the outputs that the comparison asks for
  long evaluations = 0, factors = 0, steps = 0, rejected = 0;
  std::string failure{};  ///< why there is no result, in words; "" when there is one
  bool given_up = false, interrupted = false;  ///< because its time was spent; because somebody asked for the end
  bool done() const { return failure.empty(); }
};

/// The lists' first items are the base. Every combination is charted, or those that differ from the base in one place.
struct WorkPrecisionOptions {
  std::vector<MethodChoice> integrators;
  std::vector<SolverChoice> solvers;
  std::vector<Formulation> formulations{Formulation::omega, Formulation::quaternion};
  std::vector<Stabilization::Kind> stabilizations{Stabilization::Kind::project, Stabilization::Kind::baumgarte,
                                                  Stabilization::Kind::none};
  bool separately = false;  ///< one dimension at a time
  Stabilization gains;      ///< Baumgarte's rates and the projection's tolerance
  std::vector<double> tolerances{1,    1e-1, 1e-2, 1e-3,  1e-4,  1e-5, 1e-6,
                                 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12};  ///< falling; atol_x is 1e-2 of each
  std::vector<int> steps{1,   2,   4,    8,    16,   32,   64,   128,
                         256, 512, 1024, 2048, 4096, 8192, 16384};  ///< fixed steps in an output interval, rising
  double largest_step = 0;                                          ///< of adaptive methods, s; 0: no limit

  /// Adaptive ones, the likeliest first; the two of different kinds (names up to ":") that agree best are used.
  std::vector<MethodChoice> references;
  double reference_tolerance = 1e-13;  ///< up to 1000 times wider where it cannot be met
  double budget = 60;                  ///< s of CPU time; what would not fit is left out and says so
  int repeats = 3;                     ///< of runs below `quick`; the least time counts
  double quick = 0.02;                 ///< s
  double hopeless = 100;  ///< a combination ends where it costs so many times what another took for the same error

  ErrorKind target_kind = ErrorKind::position;
  double target = 0;  ///< above 0: a combination ends when it met this error and the next finer run confirmed it

  std::function<double()> clock{};                          ///< s, what the budget goes by; default: thread_seconds
  std::function<double()> cpu{};                            ///< s; default: thread_seconds
  std::function<void(const std::string&)> progress{};       ///< told of every run before it begins
  std::function<void(const WorkPrecisionRun&)> measured{};  ///< and of every one that was made
};

struct WorkPrecision {
  std::vector<WorkPrecisionRun> runs;  ///< of one combination: from coarse to fine
  struct Unsuited {
    std::string what, why;
  };
  std::vector<Unsuited> unsuited{};     ///< combinations that this mechanism cannot have, and why
  std::vector<std::string> left_out{};  ///< runs that the budget did not reach
  std::string reference, second;        ///< "dop853 at 1e-13"
  HistoryError agreement;               ///< of the two references: below it no error means anything
  HistoryError size;  ///< largest displacement, speed, kinetic energy (or change of energy) and link load: what to
                      ///< judge errors by
};

/// Cheapest next run first, until all combinations have ended or the budget is spent. Throws StepError when no
/// reference can be made and ModelError for a trajectory or options without content; every other failure is a result.
LOCKSTEP_API WorkPrecision work_precision(const Trajectory&, const WorkPrecisionOptions&);

/// Of one combination: all but the setting is equal.
LOCKSTEP_API bool same_way(const WorkPrecisionRun&, const WorkPrecisionRun&);

LOCKSTEP_API std::string to_string(Formulation);
LOCKSTEP_API std::string to_string(Stabilization::Kind);
LOCKSTEP_API std::string to_string(ErrorKind);
LOCKSTEP_API const char* unit_of(ErrorKind);  ///< "m", "m/s", "J", "N"
/// "dop853, tolerance 1e-06, omega, project, sparse".
LOCKSTEP_API std::string label(const WorkPrecisionRun&);

/// CPU time of the calling thread, s.
LOCKSTEP_API double thread_seconds();

}  // namespace lockstep
