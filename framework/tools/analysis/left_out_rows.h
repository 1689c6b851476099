// Rows that are left out, and whether they hold when the mechanism has moved on without them.
#pragma once

#include <vector>

#include <lockstep/dynamics.h>
#include "framework/tools/analysis/row_choice.h"

namespace lockstep {

/// Whether the rows of the links in force are few enough to be held down to the smallest, for which they are factored
/// densely: 300, in a plane those of the plane, and those that are left out too.
bool are_few_rows(const System&, const std::vector<bool>& modes);

/// Leaves rows out, in addition to those that are.
void leave_out(System&, const std::vector<OwnRow>&);
/// Puts all rows that were left out back, and takes back that rows hold which nearly depend.
void take_back(System&);

/// Rows that are left out as long as it lives.
class LeftOutForNow {
 public:
  LeftOutForNow(System& system, const std::vector<OwnRow>& rows) : system_(system) {
    leave_out(system, rows);
    system.setup();
  }
  LeftOutForNow(const LeftOutForNow&) = delete;
  LeftOutForNow& operator=(const LeftOutForNow&) = delete;
  ~LeftOutForNow() { take_back(system_); }  // it was set up before with all rows: that does not throw

 private:
  System& system_;
};

/// Motions that rows which hold no more allow, followed for some way.
class LeftOutTrial {
 public:
  LeftOutTrial(System& system, Dynamics& dynamics, const State& state)
      : system_(system), dynamics_(dynamics), start_(state) {}

  /// The largest violation of `rows`, m, where what this row held moves on; HUGE_VAL where it cannot.
  double along(const OwnRow& row, const std::vector<OwnRow>& rows);

 private:
  VecX allowed(const State&, const VecX& force);
  double size_of(const VecX& v) const;

  System& system_;
  Dynamics& dynamics_;
  const State& start_;
  VecX response_;
};

}  // namespace lockstep
