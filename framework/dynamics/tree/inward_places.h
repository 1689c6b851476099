// SPDX-License-Identifier: BSD-3-Clause
// InwardPlace: where a pass from the leaves to the roots keeps what the nodes of a tree pass on.
#pragma once

#include <cstddef>
#include <vector>

namespace lockstep {

/// A node takes over from the one that comes after it if that is its child; what other children pass on waits.
struct InwardPlace {
  static constexpr int kNext = -2;
  int own = -1,  ///< where that waits, -1: nowhere
      to = -1;   ///< where what it passes on waits, -1: nowhere, it is a root; kNext: nowhere, the next takes it
};

/// The place of each node. Nodes: by their `parent`, a smaller number, -1: the ground. `n_waiting`: how many places; one is
/// free again once its node has taken what waits there.
template <class Nodes>
std::vector<InwardPlace> inward_places(const Nodes& nodes, std::size_t& n_waiting) {
  std::vector<InwardPlace> places(nodes.size());
  std::vector<int> free;
  n_waiting = 0;
  for (std::size_t k = nodes.size(); k-- > 0;) {
    InwardPlace& own = places[k];
    if (own.own >= 0) free.push_back(own.own);
    if (nodes[k].parent < 0) continue;
    const auto parent = static_cast<std::size_t>(nodes[k].parent);
    if (parent + 1 == k) {
      own.to = InwardPlace::kNext;
      continue;
    }
    InwardPlace& there = places[parent];
    if (there.own < 0 && free.empty()) free.push_back(static_cast<int>(n_waiting++));
    if (there.own < 0) there.own = free.back(), free.pop_back();
    own.to = there.own;
  }
  return places;
}

}  // namespace lockstep
