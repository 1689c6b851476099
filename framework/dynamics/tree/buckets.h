// SPDX-License-Identifier: BSD-3-Clause
// Buckets: lists of things, one after another in one array.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lockstep {

/// A list for each of n places, in the order in which things were added.
template <class Thing>
class Buckets {
 public:
  /// put(item, add) calls add(place, thing) for what an item adds; it is asked twice, and must do the same.
  template <class Items, class Put>
  Buckets(std::size_t n, const Items& items, Put&& put) : first_(n + 2, 0) {
    for (const auto& item : items) put(item, [&](std::size_t place, const Thing&) { ++first_[place + 2]; });
    for (std::size_t k = 2; k < first_.size(); ++k) first_[k] += first_[k - 1];
    things_.resize(first_.back());
    for (const auto& item : items)
      put(item, [&](std::size_t place, const Thing& t) { things_[first_[place + 1]++] = t; });
  }
  std::span<const Thing> operator[](std::size_t place) const {
    return {things_.data() + first_[place], first_[place + 1] - first_[place]};
  }

 private:
  std::vector<std::size_t> first_;  // of each place; while things are added, of the next one
  std::vector<Thing> things_;
};

}  // namespace lockstep
