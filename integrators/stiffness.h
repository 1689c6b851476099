// Stiffness: does stability, not accuracy, limit the steps of an explicit method? Hairer & Wanner, Solving Ordinary
// Differential Equations II (1996), IV.2.
//
// Two states of nearly one instant, the end of a step and a stage at c = 1, differ most in the fastest mode when the
// step is at the limit of stability, so |da| / |dv| is the rate |lambda| of that mode, and -da . dv / |dv|^2 the damped
// part of it. Stiff are damped fast modes only: an undamped oscillation must be followed by any method.
#pragma once

#include "framework/support/export.h"
#include "framework/support/snapshot.h"

namespace lockstep {

class LOCKSTEP_API StiffnessWatch {
 public:
  /// `limit`: h |lambda| at the end of the method's interval of stability on the negative axis.
  explicit StiffnessWatch(double limit) : limit_(limit) {}
  void begin() { *this = StiffnessWatch(limit_); }
  /// One accepted step of h: |dv|^2, |da|^2 and da . dv over all bodies, turns as lengths.
  void look(double h, double dv2, double da2, double da_dv);
  /// Whether the last window of 15 steps was at the limit of stability.
  bool stiff() const { return stiff_; }
  void save(Snapshot& out) const;
  void restore(const Snapshot& in);

 private:
  double limit_;
  double n_ = 0, dv2_ = 0, da2_ = 0, damped_ = 0;  // sums over the window, the rates times h
  bool stiff_ = false;
};

}  // namespace lockstep
