// SPDX-License-Identifier: BSD-3-Clause
// What is found of a run that ended.
#pragma once

#include <vector>

#include <lockstep/recorder.h>
#include <lockstep/step_loop.h>
#include "framework/tools/rank/doubts.h"
#include "framework/tools/rank/singular_watch.h"

namespace lockstep {

/// What speaks against the result of a run so far: singular positions, doubts, energy and drift; then whether it is stiff.
LOCKSTEP_API std::vector<Finding> run_findings(StepLoop&, const Audit&, const Doubts&, const SingularWatch&);

}  // namespace lockstep
