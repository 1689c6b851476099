// SPDX-License-Identifier: BSD-3-Clause
// Which links carry a slot from another: a spanning tree of the graph of links.
#pragma once

#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <cstddef>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

namespace lockstep {

/// A link between two slots; kGround is one of them.
struct GraphLink {
  int number = 0;      ///< of the link
  int a = 0, b = 0;    ///< slots
  int rows = 0;        ///< unknowns that it takes away as a joint of a tree; 0: it is no joint of a tree
};

/// The growing tree. Slots are numbered from the ground, 0.
class Growth {
 public:
  Growth(const std::vector<GraphLink>& links, int n_slots, bool from_last)
      : links_(links),
        from_last_(from_last),
        at_(static_cast<std::size_t>(n_slots + 1)),
        reached_(static_cast<std::size_t>(n_slots + 1), -1),
        seen_(static_cast<std::size_t>(n_slots + 1), -1),
        parent_(static_cast<std::size_t>(n_slots + 1), 0),
        taken_(links.size(), false) {
    for (std::size_t link = 0; link < links.size(); ++link)
      for (const int slot : {links[link].a, links[link].b}) at_[node(slot)].push_back(link);
  }

  const std::vector<bool>& tree() {
    for (std::size_t start = 0; start < reached_.size(); ++start) {
      if (reached_[start] >= 0) continue;
      reach(start, 0);
      while (!open_.empty()) {
        const std::size_t link = std::get<3>(*open_.begin());
        open_.erase(open_.begin());
        const auto [a, b] = ends(link);
        if (reached_[a] >= 0 && reached_[b] >= 0) continue;
        taken_[link] = true;
        reached_[a] >= 0 ? reach(b, a) : reach(a, b);
      }
    }
    return taken_;
  }

  // The squares of the lengths of the paths that the other links close, but no more than `most`.
  double cost(double most) const {
    double sum = 0;
    for (std::size_t link = 0; link < links_.size() && sum < most; ++link) {
      if (taken_[link]) continue;
      auto [a, b] = ends(link);
      double length = 0;
      for (; a != b && length * length < most; ++length)
        (reached_[a] > reached_[b] ? a : b) = parent_[reached_[a] > reached_[b] ? a : b];
      sum += length * length;
    }
    return sum;
  }

 private:
  static constexpr std::size_t kLookAround = 64;  // slots: a loop that is not closed within them counts as long

  static std::size_t node(int slot) { return slot + 1; }
  std::pair<std::size_t, std::size_t> ends(std::size_t link) const {
    return {node(links_[link].a), node(links_[link].b)};
  }
  std::size_t other(std::size_t link, std::size_t than) const {
    const auto [a, b] = ends(link);
    return a == than ? b : a;
  }

  void reach(std::size_t slot, std::size_t parent) {
    reached_[slot] = count_++, parent_[slot] = parent;
    for (const std::size_t link : at_[slot])
      if (const std::size_t to = other(link, slot); links_[link].rows > 0 && reached_[to] < 0)
        open_.insert(
            {-links_[link].rows, from_last_ ? -reached_[slot] : reached_[slot], from_last_ ? loop(to, link) : 0, link});
  }

  // Slots on the shortest way from a slot back to the tree, by another link than this.
  std::size_t loop(std::size_t from, std::size_t by) {
    ++look_;
    queue_.assign(1, {from, 1});
    seen_[from] = look_;
    for (std::size_t next = 0; next < queue_.size() && queue_.size() < kLookAround; ++next) {
      const auto [slot, length] = queue_[next];
      for (const std::size_t link : at_[slot]) {
        const std::size_t to = other(link, slot);
        if (link == by || seen_[to] == look_) continue;
        if (reached_[to] >= 0) return length;
        seen_[to] = look_;
        queue_.emplace_back(to, length + 1);
      }
    }
    return kLookAround;
  }

  const std::vector<GraphLink>& links_;
  bool from_last_;
  std::vector<boost::container::small_vector<std::size_t, 4>> at_;  // links of each slot
  std::vector<int> reached_;         // of each slot: as which; -1: not yet
  std::vector<int> seen_;            // of each slot: by which look around
  std::vector<std::size_t> parent_;  // of each slot
  std::vector<bool> taken_;
  std::set<std::tuple<int, int, std::size_t, std::size_t>> open_;  // -rows, -reached, loop, link
  std::vector<std::pair<std::size_t, std::size_t>> queue_;         // of a look around: slots, and how far they are
  int count_ = 0, look_ = -1;
};

/// Whether each of these links is in the tree. Joints that hold most go first, so that few unknowns are left. Of equals
/// there are two trees: one grows from the slot that was reached last, along the shortest loop that it can close, the
/// other from the slot that was reached first. Taken is the one in which the paths on which closures carry their rows
/// are shorter: in a ladder the first, in a row of four-bars on the ground the second.
inline std::vector<bool> spanning_tree(const std::vector<GraphLink>& links, int n_slots) {
  Growth first(links, n_slots, false);
  if (std::ranges::all_of(first.tree(), [](bool taken) { return taken; })) return first.tree();
  Growth last(links, n_slots, true);
  last.tree();
  double limit = 64;  // the time goes with the smaller of both
  while (first.cost(limit) >= limit && last.cost(limit) >= limit) limit *= 4;
  return first.cost(limit) < last.cost(limit) ? first.tree() : last.tree();
}

}  // namespace lockstep
