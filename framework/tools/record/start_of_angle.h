// The turn in which the channel of an angle begins.
#pragma once

#include <lockstep/recorder.h>

namespace lockstep::channels {

/// The angle begins on the branch nearest to this one, rad, at every start. Of a channel that is no angle: nothing.
LOCKSTEP_API void begin_about(Channel&, double angle);

}  // namespace lockstep::channels
