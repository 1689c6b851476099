// SPDX-License-Identifier: BSD-3-Clause
// Requirements: the conditions "require" of a scene, over a run.
#pragma once

#include <memory>
#include <vector>

#include <lockstep/recorder.h>
#include <lockstep/scene.h>

namespace lockstep {

/// By how much the conditions of a scene hold: an observer of their extremes, which keeps no rows; null without conditions.
/// Make it before the StepLoop, as the recorder. Throws SceneError with the place in the file of an invalid one.
LOCKSTEP_API std::unique_ptr<Recorder> make_requirements(Mechanism&);

/// Those that did not hold in a run, with the worst instant.
LOCKSTEP_API std::vector<Finding> broken_requirements(const Mechanism&, const Recorder*);

}  // namespace lockstep
