// SPDX-License-Identifier: BSD-3-Clause
// The Pareto front of cost and error, and the cost of a given error.
#pragma once

#include <vector>

#include "framework/tools/precision/work_precision.h"

namespace lockstep {

/// The cost of a run: CPU time or evaluations.
enum class CostKind { cpu, evaluations };
LOCKSTEP_API double cost(const WorkPrecisionRun&, CostKind);

/// Not wrong, nor accurate by chance: the run is complete, and no finer run of its combination failed or has more than twice its
/// error. Differences below the agreement of the references are ignored, and so are runs that ran out of time.
LOCKSTEP_API bool counts(const WorkPrecision&, const WorkPrecisionRun&, ErrorKind = ErrorKind::position);

/// The runs that count and of which no other is both cheaper and more accurate; cheapest first.
LOCKSTEP_API std::vector<const WorkPrecisionRun*> pareto_front(const WorkPrecision&, ErrorKind = ErrorKind::position,
                                                               CostKind = CostKind::cpu);

/// The coarsest run of a combination that counts and meets the error. It is an upper bound if no coarser run missed the
/// error: a cheaper one might meet it too.
struct CostAtError {
  const WorkPrecisionRun* run = nullptr;
  bool upper_bound = false;
  bool confirmed = false;  ///< a finer run was made
};

/// One per combination that met the error, least CPU time first.
LOCKSTEP_API std::vector<CostAtError> costs_at_error(const WorkPrecision&, double error,
                                                     ErrorKind = ErrorKind::position);

inline constexpr double kTie = 1.2;  ///< factor between CPU times that differ by chance
/// Of those costs the one to recommend, null if there is none: confirmed if one is, and of those that cost about as much
/// as the cheapest, the nearest to the base.
LOCKSTEP_API const CostAtError* recommended(const std::vector<CostAtError>&);

}  // namespace lockstep
