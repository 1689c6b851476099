// SPDX-License-Identifier: BSD-3-Clause
// Contacts: the unilateral links of a system and their gaps. Internal to the step loop.
#pragma once

#include <vector>

#include <lockstep/dynamics.h>

namespace lockstep {

/// The gap of a unilateral link, c = +-C, which is free above zero, and its rate.
struct Gap {
  double c = 0, cd = 0;
};

struct Contact {
  const Lock* link = nullptr;
  double sign = 1;      ///< +1 where C >= 0 is free
  double margin = 0;    ///< gaps that differ by less are the same, in the unit of C
  double floor = 0;     ///< the gap at which it touches: 0, or below, where it was released
  Gap gap;              ///< at the beginning of the present step
  double push = 0;      ///< there, while in force: its multiplier, positive when it pushes
  double push_now = 0;  ///< where it was evaluated last

  double restitution() const { return link->unilateral()->restitution; }
  double rest_speed() const { return link->unilateral()->rest_speed; }
  bool above(const Gap& g) const { return g.c > floor + margin; }
  /// Whether it touches at the beginning of the step, and leaves at a speed.
  bool leaves() const { return !above(gap) && gap.cd > margin; }
  /// Takes note of a gap while it is free.
  void see(const Gap& g) {
    if (g.c > margin) floor = 0;
  }
  /// Released, or hit, at this gap.
  void leave(const Gap& g) { floor = g.c < 0 ? g.c : 0; }
};

class LOCKSTEP_API Contacts {
 public:
  /// Collects the unilateral links.
  void lay_out(const System& system, const Stabilization& stabilization);
  bool empty() const { return all_.empty(); }
  std::size_t size() const { return all_.size(); }
  Contact& operator[](std::size_t i) { return all_[i]; }
  const Contact& operator[](std::size_t i) const { return all_[i]; }

  bool in_force(std::size_t i, const State& s) const { return s.modes[number(i)]; }
  /// Whether no event has switched it off.
  bool watched(std::size_t i, const State& s) const { return s.watched[number(i)]; }
  void put(std::size_t i, bool in_force, State& s) const { s.modes[number(i)] = in_force; }
  int number(std::size_t i) const { return all_[i].link->number(); }

  /// The gap as the link sees it, whether or not it is in force.
  Gap gap(std::size_t i, const Inputs&);
  /// The second derivative of its gap at these accelerations.
  double gap_dd(std::size_t i, const Evaluated&);
  /// Its row in the table; -1: not in force.
  int row(std::size_t i, const RowTable&) const;

 private:
  std::vector<Contact> all_;
  RowTable room_;  // scratch, for one row in space
};

}  // namespace lockstep
