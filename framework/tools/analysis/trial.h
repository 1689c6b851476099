// Trial: one charted run from start to end; for the work_precision*.cpp files only.
#pragma once

#include <string>

#include "framework/tools/analysis/history.h"

namespace lockstep {

/// One way to run: a rung of the ladder of one combination.
struct Recipe {
  const MethodChoice* method;
  const SolverChoice* solver;
  DynamicsOptions dynamics{};
  Tolerance tolerance{};
  double step = 0;
};

struct Outcome {
  History history;
  double cpu = 0;  ///< s, without what looking took
  WorkCount work;  ///< likewise
  SimulationReport report;
  std::string failure{};
  bool unsuited = false;  ///< it did not make a step because the mechanism is none for it
  bool given_up = false;  ///< over the limit
  bool interrupted = false;  ///< somebody asked for the end
  bool dense = false;     ///< outputs do not change its steps
};

/// looked: with a history at the instants of comparison. bare: only the steps, for methods whose outputs come between
/// them; truth: looked, and by the trajectory's own means for it.
enum class TrialKind { looked, bare, truth };

/// What time is measured by, s: the budget's clock, and what a run costs.
struct Clocks {
  std::function<double()> clock, cpu;
};

/// `limit`: s by that clock after which the run is given up. What goes wrong stands in the outcome.
Outcome try_run(const Trajectory&, const Recipe&, double limit, const Clocks&, TrialKind kind = TrialKind::looked);

}  // namespace lockstep
