// Reference: the truth that charted runs are held against; for the work_precision*.cpp files only.
#pragma once

#include <string>

#include "framework/tools/analysis/trial.h"

namespace lockstep {

struct Reference {
  History truth;
  HistoryError agreement;    ///< with the second method's history
  std::string name, second;  ///< "dop853 at 1e-13"
  double length = 0;         ///< of the system, m
};

/// The two methods of different kinds that agree best, the first of them being the truth; wider tolerances where the
/// tightest cannot be met; in need one method at two tolerances. Throws StepError when none comes to the end.
Reference make_reference(const Trajectory&, const WorkPrecisionOptions&, const Clocks&);

}  // namespace lockstep
