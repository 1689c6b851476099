// Channels: what can be recorded, by name. "crank.angle_z", "B.force_on_p_world_x", "energy.total".
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "framework/dynamics/simulate/observer.h"

namespace lockstep {

struct Channel {
  std::string name, unit;
  std::function<double(const Sample&)> value;
  /// Called at the start of a run and at every accepted step, when present: counts turns, rejected tries.
  std::function<void(const Sample&)> track{};
  std::function<void(const Sample&)> jumped{};  ///< the same instant once more, with other velocities
  /// Called before that at the start of a run, when present: forgets what an earlier run left behind.
  std::function<void()> restart{};
};

/// One name of a system with its unit and a line of help.
struct ChannelHelp {
  std::string name, unit, help;
};

/// The channel of that name. Sets the system up when it is not (a link's rows have names only then). Work-like channels
/// add a quadrature to the system, one for all who ask, so make channels before the run (before StepLoop takes the
/// start). The system must stay where it is in memory from then on. Throws ModelError with the closest name and all
/// names that the object has.
LOCKSTEP_API Channel make_channel(System&, const std::string& name);

/// Every channel of the system, those of pairs ("M.x@N") left out; rows of links only when it is set up.
LOCKSTEP_API std::vector<ChannelHelp> channel_help(const System&);

}  // namespace lockstep
