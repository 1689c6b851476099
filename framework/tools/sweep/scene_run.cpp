#include "framework/tools/sweep/scene_run.h"

#include <lockstep/error.h>
#include <lockstep/solvers.h>
#include "framework/dynamics/solvers/graph.h"

namespace lockstep {
namespace {

constexpr double kOn = 1e-6;  // m, times the length: nearer than this a start is on the constraints but for its digits

// Dependent rows leave a small pivot, in the factor of one solver whatever that of the run is.
bool may_depend(System& system, const State& state) {
  constexpr double kSmall = 1e-2;
  const SchurSolver solver;
  const Evaluation evaluation(system, state);
  WorkCount work;
  Factor factor(system, solver, Formulation::omega, work);
  factor.compute(evaluation);
  SolveReport report;
  factor.complete(report);
  return report.smallest_pivot < kSmall;
}

}  // namespace

std::vector<NearDependency> decide_nearly_redundant(Dynamics& dynamics, Mechanism& m) {
  State start = m.system.start();
  if (!has_loops(m.system, start.modes)) return {};
  try {
    if (dynamics.violation(start) > kOn * m.system.length()) {
      if (!m.run.assemble) return {};
      assemble(dynamics, start, m.start_speeds, m.assembly);
    } else {
      if (!may_depend(m.system, start)) return {};
      dynamics.project(start);
    }
    return decide_nearly_redundant(m.system, dynamics, start, m.run.nearly_redundant);
  } catch (const Error&) {  // the run says what is wrong
    return {};
  }
}

}  // namespace lockstep
