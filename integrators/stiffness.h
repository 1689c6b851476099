// Stiffness: do damped fast modes, not the motion, limit the steps of an explicit method? After Hairer & Wanner,
// Solving Ordinary Differential Equations II (1996), IV.2.
//
// Two states of nearly one instant, the end of a step and a stage at c = 1, differ most in the fastest mode, so |da| /
// |dv| is the rate |lambda| of that mode, and -da . dv / |dv|^2 the damped part of it. Stiff is a damped mode that is
// faster than two steps although the accelerations hardly change over fifteen: it has long decayed and still sets the
// step. An undamped oscillation must be followed by any method, a mode that is decaying now as well.
#pragma once

#include "framework/foundation/math/pose.h"
#include "framework/foundation/support/export.h"
#include "framework/foundation/support/snapshot.h"

namespace lockstep {

class LOCKSTEP_API StiffnessWatch {
 public:
  /// `limit`: h |lambda| at the end of the method's interval of stability on the negative axis.
  explicit StiffnessWatch(double limit) : limit_(limit) {}
  /// Forgets everything; sizes its scratch for so many velocities.
  void begin(Eigen::Index n_velocities = 0);
  /// One accepted step of h: velocities at its end less those of a stage at c = 1, the accelerations of that stage and
  /// of the end. Turns count as lengths, times `length`.
  void observe(double h, const VecX& dv, const VecX& a_stage, const VecX& a_end, double length);
  /// The same by its sums |dv|^2, |da|^2 and da . dv over all bodies; `change`: of the accelerations since the window
  /// began, relative.
  void add(double h, double dv2, double da2, double da_dv, double change);
  /// Whether damped fast modes limited the last window of 15 steps.
  bool stiff() const { return stiff_; }
  void save(Snapshot& out) const;
  void restore(const Snapshot& in);

 private:
  double limit_;
  double n_ = 0, rate2_ = 0, damped_ = 0;  // steps, and sums over them: (h |lambda|)^2, h times the damped part
  bool stiff_ = false;
  VecX a_before_;  // at the beginning of the window
};

}  // namespace lockstep
