// The turn in which the channel of an angle begins.
#pragma once

#include <string>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>

namespace lockstep::channels {

/// The angle begins on the branch nearest to this one, rad, at every start. Of a channel that is no angle: nothing.
LOCKSTEP_API void begin_about(Channel&, double angle);

/// Names, of these, the angles of links whose turns nothing counts before the run, where the start may be beyond half a
/// turn of them: they begin within half a turn of zero all the same. One sentence with the way out; "" where there are none.
LOCKSTEP_API std::string uncounted(const System&, const AssemblyOptions&, const std::vector<ChannelRequest>& recorded);

}  // namespace lockstep::channels
