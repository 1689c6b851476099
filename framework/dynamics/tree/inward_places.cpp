#include "framework/dynamics/tree/inward_places.h"

namespace lockstep {

std::vector<InwardPlace> inward_places(std::span<const int> parents, std::size_t& n_waiting) {
  std::vector<InwardPlace> places(parents.size());
  n_waiting = 0;
  for (std::size_t k = parents.size(); k-- > 0;) {
    if (parents[k] < 0) continue;
    const auto parent = static_cast<std::size_t>(parents[k]);
    InwardPlace &own = places[k], &there = places[parent];
    if (parent + 1 == k) {
      own.to = InwardPlace::kNext, there.from_next = true;
      continue;
    }
    own.first = there.own < 0;
    if (own.first) there.own = static_cast<int>(n_waiting++);
    own.to = there.own;
  }
  return places;
}

}  // namespace lockstep
