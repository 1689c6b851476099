// Pareto: which of the charted runs count, which of them nothing beats, and what a wanted error costs.
#pragma once

#include <vector>

#include "framework/tools/analysis/work_precision.h"

namespace lockstep {

/// What a run costs.
enum class CostKind { cpu, evaluations };
LOCKSTEP_API double cost(const WorkPrecisionRun&, CostKind);

/// No lucky hit: it is done, and no finer run of its combination failed or errs more than twice as much. Differences
/// below the agreement of the references are none. Time that ran out says nothing against the coarser runs.
LOCKSTEP_API bool counts(const WorkPrecision&, const WorkPrecisionRun&, ErrorKind = ErrorKind::position);

/// The runs that count and that no other such run beats in cost and error both; cheapest first.
LOCKSTEP_API std::vector<const WorkPrecisionRun*> pareto_front(const WorkPrecision&, ErrorKind = ErrorKind::position,
                                                               CostKind = CostKind::cpu);

/// The coarsest run of a combination that counts and meets the error. An upper bound: there is no coarser run that
/// missed it, so a cheaper one might meet it too.
struct CostAtError {
  const WorkPrecisionRun* run = nullptr;
  bool upper_bound = false;
  bool confirmed = false;  ///< a finer run was made
};

/// One for each combination that met the error, least CPU time first.
LOCKSTEP_API std::vector<CostAtError> costs_at_error(const WorkPrecision&, double error,
                                                     ErrorKind = ErrorKind::position);

}  // namespace lockstep
