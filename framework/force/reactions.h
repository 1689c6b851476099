// Reactions: the multipliers of the links in force, as a force that depends on them sees them.
#pragma once

#include <array>
#include <span>

#include "framework/kkt/rows.h"
#include "framework/lock/lock.h"

namespace lockstep {

class Reactions {
 public:
  Reactions(const RowTable& rows, std::span<const double> lambda) : rows_(rows), lambda_(lambda) {}

  bool in_force(const Lock& link) const { return entry(link) >= 0; }
  /// Multipliers of the link, by its own rows; zero for rows that a planar mechanism leaves out and while the link is
  /// not in force. The generalised force on the bodies is -Jh^T lambda (2.1).
  std::array<double, kMaxRows> of(const Lock& link) const {
    std::array<double, kMaxRows> lambda{};
    if (entry(link) < 0) return lambda;
    const RowEntry& e = rows_.entries[static_cast<std::size_t>(entry(link))];
    for (std::size_t k = 0; k < static_cast<std::size_t>(e.m); ++k)
      lambda[static_cast<std::size_t>(e.own[k])] = lambda_[static_cast<std::size_t>(e.first_row) + k];
    return lambda;
  }

 private:
  int entry(const Lock& link) const { return rows_.entry_of_link[static_cast<std::size_t>(link.number())]; }
  const RowTable& rows_;
  std::span<const double> lambda_;
};

}  // namespace lockstep
