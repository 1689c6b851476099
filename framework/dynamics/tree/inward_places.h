// InwardPlace: where a pass from the leaves to the roots keeps what the nodes of a tree pass on.
#pragma once

#include <span>
#include <vector>

namespace lockstep {

/// A node takes over from the one that comes after it if that is its child; what other children pass on waits.
struct InwardPlace {
  static constexpr int kNext = -2;
  bool from_next = false;
  int own = -1,        ///< where that waits, -1: nowhere
      to = -1;         ///< where what it passes on waits, -1: nowhere; kNext: nowhere, the next takes it
  bool first = false;  ///< it is the first that waits there
};

/// The place of each node, by the numbers of their parents, which are smaller; -1: the ground. `n_waiting`: how many wait.
std::vector<InwardPlace> inward_places(std::span<const int> parents, std::size_t& n_waiting);

}  // namespace lockstep
