// SPDX-License-Identifier: BSD-3-Clause
// Reference: the solution to which measured runs are compared. Private to the work_precision*.cpp files.
#pragma once

#include <string>

#include "framework/tools/precision/attempt.h"

namespace lockstep {

struct Reference {
  History truth;
  HistoryError agreement;    ///< with the second method's history
  std::string name, second;  ///< "dop853 at 1e-13"
  double length = 0;         ///< of the system, m
};

/// The two methods of different kinds that agree best; the first of them is the reference. Uses wider tolerances if the
/// tightest cannot be met, and one method at two tolerances if need be. Throws StepError if no run reaches the end.
Reference make_reference(const Trajectory&, const WorkPrecisionOptions&, const Clocks&);

}  // namespace lockstep
