// Contacts: the unilateral links of a system, and how far each is from holding. Internal to the step loop.
#pragma once

#include <vector>

#include <lockstep/dynamics.h>

namespace lockstep {

/// The row of a unilateral link, counted so that it is free above zero: c = +-C and its rate.
struct Gap {
  double c = 0, cd = 0;
};

struct Contact {
  const Lock* link = nullptr;
  double sign = 1;      ///< +1 where C >= 0 is free
  double margin = 0;    ///< gaps closer together than this are one, in the unit of C
  double floor = 0;     ///< the gap at which it is touched: 0, or a rounding below, where it was let go
  bool clear = false;   ///< whether it has been above that by the margin since
  Gap gap;              ///< at the beginning of the present step
  double push = 0;      ///< there, while in force: its multiplier, counted so that it pushes above zero
  double push_now = 0;  ///< where it was looked at last

  double restitution() const { return link->unilateral()->restitution; }
  double rest_speed() const { return link->unilateral()->rest_speed; }
  bool above(const Gap& g) const { return g.c > floor + margin; }
  /// What a gap says about the flight.
  void see(const Gap& g) {
    clear = clear || above(g);
    if (g.c > margin) floor = 0;
  }
  /// Let go, or hit, at this gap.
  void leave(const Gap& g) {
    floor = g.c < 0 ? g.c : 0;
    clear = above(g);
  }
};

class Contacts {
 public:
  /// Whom to watch.
  void lay_out(const System& system, const Stabilization& stabilization);
  bool empty() const { return all_.empty(); }
  std::size_t size() const { return all_.size(); }
  Contact& operator[](std::size_t i) { return all_[i]; }
  const Contact& operator[](std::size_t i) const { return all_[i]; }

  bool in_force(std::size_t i, const State& s) const { return s.modes[static_cast<std::size_t>(number(i))]; }
  /// Whether no event has switched it off.
  bool watched(std::size_t i, const State& s) const { return s.watched[static_cast<std::size_t>(number(i))]; }
  void put(std::size_t i, bool in_force, State& s) const { s.modes[static_cast<std::size_t>(number(i))] = in_force; }
  int number(std::size_t i) const { return all_[i].link->number(); }

  /// The gap as the link sees it, whether or not it is in force.
  Gap gap(std::size_t i, const Inputs&);
  /// Its second rate at these accelerations.
  double gap_dd(std::size_t i, const Evaluated&);
  /// Its row in the table; -1: not in force.
  int row(std::size_t i, const RowTable&) const;

 private:
  RowView gathered(const Lock&, const Inputs&);
  std::vector<Contact> all_;
  RowTable room_;  // for one row that is in no table
};

}  // namespace lockstep
