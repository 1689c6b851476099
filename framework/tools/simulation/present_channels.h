// SPDX-License-Identifier: BSD-3-Clause
// Values of channels at the present time of a run, between its steps.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/recorder.h>

namespace lockstep {

class Simulation;

class LOCKSTEP_API PresentChannels {
 public:
  /// A column of `recorded`, names and their channels, or a channel of the system. Throws ModelError, also for one that
  /// depends on the motion before, or needs a state that a run which has begun lacks.
  const Channel& channel(Simulation&, const std::vector<std::pair<std::string, std::string>>& recorded,
                         const std::string& name);
  /// Its value. The mechanism is evaluated once for all channels, until pass() is called.
  double value(Simulation&, const Channel&);
  /// The state changes.
  void pass() { now_.reset(); }

 private:
  std::map<std::string, Channel> channels_;
  std::optional<Sample> now_;
  StepReport none_{};
};

}  // namespace lockstep
