// Work against precision: what accuracy costs. Every given combination of integrator, formulation, stabilisation and
// solver runs over a ladder of tolerances or steps; each run is held against a reference over its whole history.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/dynamics/simulation.h"
#include "framework/record/chart.h"

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
struct Course {
  std::function<Subject()> make;
  double length = 0;  ///< s
  int outputs = 50;
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

struct WorkPrecisionOptions {
  std::vector<MethodChoice> integrators;
  std::vector<SolverChoice> solvers;
  std::vector<Formulation> formulations{Formulation::omega, Formulation::quaternion};
  std::vector<Stabilization::Kind> stabilizations{Stabilization::Kind::project, Stabilization::Kind::baumgarte,
                                                  Stabilization::Kind::none};
  Stabilization gains;  ///< Baumgarte's rates and the projection's tolerance
  std::vector<double> tolerances{1e-2, 1e-3, 1e-4, 1e-5,  1e-6,
                                 1e-7, 1e-8, 1e-9, 1e-10, 1e-11};  ///< falling; atol_x is 1e-2 of each
  std::vector<int> steps{1,   2,   4,   8,    16,   32,   64,
                         128, 256, 512, 1024, 2048, 4096, 8192};  ///< fixed steps in an output interval, rising
  MethodChoice reference,
      second;  ///< adaptive both, of different kinds; the tightest runs give truth and its own error
  double reference_tolerance = 1e-13;
  double budget = 60;                                  ///< s by the clock; what would not fit is left out and says so
  int repeats = 3;                                     ///< of runs below `quick`; the least time counts
  double quick = 0.1;                                  ///< s
  std::function<void(const std::string&)> progress{};  ///< told of every run
};

/// Largest over the history and over the bodies.
struct HistoryError {
  double position = 0;  ///< m: of the mass centre, and of the turn (rad) times the system's length
  double velocity = 0;  ///< m/s, alike
  double energy = 0;    ///< J, of kinetic and potential energy together
};

struct WorkPrecisionRun {
  std::string integrator, solver;
  Formulation formulation = Formulation::omega;
  Stabilization::Kind stabilization = Stabilization::Kind::project;
  bool adaptive = false;
  double setting = 0;  ///< relative tolerance, or step in s
  HistoryError error;
  double cpu = 0;  ///< s of this thread
  long evaluations = 0, steps = 0, rejected = 0;
  std::string failure{};  ///< why there is no result, in words; "" when there is one
  bool done() const { return failure.empty(); }
};

struct WorkPrecision {
  std::vector<WorkPrecisionRun> runs;
  std::vector<std::string> left_out{};  ///< runs that the budget did not reach
  std::string reference, second;        ///< names
  HistoryError agreement;               ///< of the two references: below it no error means anything
  HistoryError size;  ///< largest displacement, speed and energy change of the reference, to judge errors by
};

/// Throws what the reference throws when it cannot be made; every other failure is a result.
LOCKSTEP_API WorkPrecision work_precision(const Course&, const WorkPrecisionOptions&);

LOCKSTEP_API std::string to_string(Formulation);
LOCKSTEP_API std::string to_string(Stabilization::Kind);
/// "dop853, tolerance 1e-06, omega, project".
LOCKSTEP_API std::string label(const WorkPrecisionRun&);

/// CPU time of the calling thread, s.
LOCKSTEP_API double thread_seconds();

/// One line a run with names in words, header with units; failures with their reason. Throws FileError.
LOCKSTEP_API void write_runs(const std::string& file, const WorkPrecision&);

/// Which of the runs a picture shows, and what distinguishes its curves.
enum class ChartBy { integrator, form };

/// Position error over CPU time, log-log. ChartBy::integrator: one curve an integrator, at the first formulation, first
/// solver and `kind`. ChartBy::form: one panel an integrator of `only` (all when empty), one curve a pair of
/// formulation and stabilisation. Failures are grey marks at the top, at the time they took.
LOCKSTEP_API ChartSpec work_precision_chart(const WorkPrecision&, const std::string& title, ChartBy by,
                                            Stabilization::Kind kind = Stabilization::Kind::project,
                                            const std::vector<std::string>& only = {});

/// The run of least CPU time whose position error is at most `error`; nullptr when none reached it.
LOCKSTEP_API const WorkPrecisionRun* cheapest(const WorkPrecision&, double error);

}  // namespace lockstep
