// SPDX-License-Identifier: BSD-3-Clause
// One measured run from start to end. Private to the work_precision*.cpp files.
#pragma once

#include <string>

#include "framework/tools/precision/history.h"

namespace lockstep {

/// How to run: one combination at one tolerance or step.
struct Recipe {
  const MethodChoice* method;
  const SolverChoice* solver;
  DynamicsOptions dynamics{};
  Tolerance tolerance{};
  double step = 0;
};

struct Outcome {
  History history;
  double cpu = 0;  ///< s, without the cost of observing
  WorkCount work;  ///< likewise
  SimulationReport report;
  std::string failure{};
  bool unsuited = false;     ///< the method cannot run this mechanism: it made no step
  bool given_up = false;     ///< it exceeded the limit
  bool interrupted = false;  ///< by the user
  bool wrong = false;        ///< by the subject's audit, of an observed run
  bool dense = false;        ///< outputs do not change its steps
  Formulation used = Formulation::automatic;  ///< that which automatic chose
};

/// observed: with a history at the times of comparison. plain: steps only, for methods with dense output, which does not
/// change them. reference: observed, of the mechanism that the trajectory provides for the reference.
enum class RunKind { observed, plain, reference };

/// Clocks, s: that of the budget, and that of the cost of a run.
struct Clocks {
  std::function<double()> clock, cpu;
};

/// `limit`: s of the budget's clock after which the run is given up. Failures are part of the outcome.
Outcome attempt_run(const Trajectory&, const Recipe&, double limit, const Clocks&, RunKind kind = RunKind::observed);

}  // namespace lockstep
