// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/simulation/present_channels.h"

#include <algorithm>

#include <lockstep/error.h>
#include <lockstep/simulation.h>

namespace lockstep {

const Channel& PresentChannels::channel(Simulation& run,
                                        const std::vector<std::pair<std::string, std::string>>& recorded,
                                        const std::string& name) {
  if (const auto known = channels_.find(name); known != channels_.end()) return known->second;
  const auto own = std::ranges::find(recorded, name, &std::pair<std::string, std::string>::first);
  Channel made = make_channel(run.system(), own == recorded.end() ? name : own->second);
  if (made.memory || made.of_motion)
    throw ModelError("\"" + name + "\" depends on the motion before; read its column of the table");
  return channels_.emplace(name, std::move(made)).first->second;
}

double PresentChannels::value(Simulation& run, const Channel& channel) {
  if (!now_) now_.emplace(run.dynamics(), run.state(), none_);
  return channel.value(*now_);
}

}  // namespace lockstep
