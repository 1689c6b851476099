// Event: changes the set of links in force between two steps, by time or by a condition located to tolerance.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "framework/dynamics/simulate/observer.h"

namespace lockstep {

struct Event {
  enum class Crossing { any, rising, falling };
  std::string name;
  /// By time: at >= 0 and no condition. By condition: value(sample) passes zero in the given sense.
  double at = -1;
  std::function<double(const Sample&)> value{};
  Crossing crossing = Crossing::any;
  double tolerance = 1e-9;                            ///< of the instant, s
  bool once = true;                                   ///< or at every crossing
  std::vector<std::string> activate{}, deactivate{};  ///< links
  bool stop = false;                                  ///< end the run there
  std::function<void(State&)> change{};               ///< anything else; velocities are made consistent afterwards
};

}  // namespace lockstep
