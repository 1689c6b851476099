// The recorder and the events of a mechanism that came from a scene.
#pragma once

#include <memory>

#include "framework/tools/record/recorder.h"
#include "framework/description/scene/scene.h"

namespace lockstep {

/// Asks for the places of the bodies that move where the scene asks for nothing.
LOCKSTEP_API void record_places(Mechanism&);

/// A recorder with the channels that the scene asks for. Make it before the StepLoop; the mechanism must stay where
/// it is in memory. Throws SceneError with the place of a channel that does not exist.
LOCKSTEP_API std::unique_ptr<Recorder> make_recorder(Mechanism&);

/// The scene's events with their conditions. Make them before the StepLoop too; `recorder` follows their channels.
LOCKSTEP_API std::vector<Event> make_events(Mechanism&, Recorder& recorder);

}  // namespace lockstep
