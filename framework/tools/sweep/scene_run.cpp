#include "framework/tools/sweep/scene_run.h"

#include <algorithm>

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

// Puts the start on the constraints; false: it is off them, or no row of it depends on others.
bool find_pose(Dynamics& dynamics, Mechanism& m, State& start) {
  if (dynamics.violation(start) > kOn * m.system.length()) {
    if (!m.run.assemble) return false;
    assemble(dynamics, start, m.start_speeds, m.assembly);
  } else {
    if (!may_depend(m.system, start)) return false;
    dynamics.project(start);
  }
  return true;
}

// Rows that were left out would stay so when those that hold their directions are released.
void refuse_switched(const Mechanism& m, const NearDependency& decided) {
  for (const EventRequest& request : m.events)
    for (const auto* names : {&request.event.activate, &request.event.deactivate})
      for (const std::string& link : decided.links)
        if (std::ranges::find(*names, link) != names->end())
          throw ModelError("\"nearly_redundant\" of \"run\" is \"" +
                           std::string(m.run.nearly_redundant == NearlyRedundant::held ? "held" : "free") +
                           "\", and event '" + request.event.name + "' switches link '" + link +
                           "', on whose loop rows nearly depend on others: what is decided at the start is wrong then; "
                           "leave it \"told\"");
}

}  // namespace

State decided_start(Dynamics& dynamics, Mechanism& m, std::vector<NearDependency>* near) {
  State start = m.system.start();
  if (m.run.nearly_redundant == NearlyRedundant::told || !has_loops(m.system, start.modes)) return start;
  State pose = start;
  try {
    if (!find_pose(dynamics, m, pose)) return start;
    dynamics.to_slots(pose);
  } catch (const Error&) {  // the run says what is wrong
    return start;
  }
  const std::vector<NearDependency> found = decide_nearly_redundant(m.system, dynamics, pose, m.run.nearly_redundant);
  for (const NearDependency& d : found) {
    if (!d.decided) continue;
    refuse_switched(m, d);
    start = m.system.start();
    start.q = pose.q;
  }
  if (near != nullptr) *near = found;
  return start;
}

std::vector<NearDependency> nearly_redundant_at(Dynamics& dynamics, Mechanism& m, const State& start) {
  if (!has_loops(m.system, start.modes)) return {};
  try {
    State pose = start;
    dynamics.to_slots(pose);
    if (dynamics.violation(pose) > kOn * m.system.length() || !may_depend(m.system, pose)) return {};
    return decide_nearly_redundant(m.system, dynamics, pose, NearlyRedundant::told);
  } catch (const Error&) {  // the run says what is wrong
    return {};
  }
}

}  // namespace lockstep
