// SPDX-License-Identifier: BSD-3-Clause
// A mechanism at one state, for the analyses that linearise it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>

namespace lockstep {

class Simulation;

/// The mechanism of a scene in space (unless the scene or --planar gives a plane), at one time.
struct MechanismAt {
  std::unique_ptr<Mechanism> mechanism;
  std::unique_ptr<Dynamics> dynamics;  ///< six velocities a body, without stabilisation
  State state;                         ///< in the coordinates of the bodies
};
/// Makes the dynamics. No channels may be made afterwards that add integrated states.
LOCKSTEP_API MechanismAt mechanism_at(std::unique_ptr<Mechanism>, const Registry&, State);

/// The assembled start of a mechanism in the slots' own coordinates; or the present state of a run of the same scene, if
/// there is one, whose inputs the mechanism takes. Throws ModelError if the run was changed after its scene was read.
LOCKSTEP_API State start_or_present(Mechanism&, Dynamics&, Simulation* run);

/// Calls an analysis; its error for a state that is no steady motion gets the next move in the host's words.
template <class Analysis>
auto with_advice(const char* advice, Analysis&& analysis) {
  try {
    return analysis();
  } catch (const ModelError& error) {
    const std::string words = error.what();
    if (words.find("neither an equilibrium") == std::string::npos) throw;
    throw ModelError(words.substr(0, words.find("; use an equilibrium")) + advice);
  }
}

/// Channels by their names, or by those of columns that the scene records.
LOCKSTEP_API std::vector<Channel> channels_of(Mechanism&, const std::vector<std::string>& names);

}  // namespace lockstep
