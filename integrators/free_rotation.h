// FreeRotation: the torque-free turning of a rigid body, split into turns about its principal axes.
//
//   H = p1^2/(2 J1) + p2^2/(2 J2) + p3^2/(2 J3),  each part an exact turn: p <- R_k(-a) p, e <- e exp(a e_k), a = p_k
//   t/J_k
//
// composed as 1(t/2) 2(t/2) 3(t) 2(t/2) 1(t/2): symmetric, symplectic, order 2, |p| and the moment of momentum in space
// kept exactly (Dullweber, Leimkuhler & McLachlan 1997).
#pragma once

#include "framework/foundation/math/quaternion.h"
#include "framework/foundation/support/export.h"

namespace lockstep {

class LOCKSTEP_API FreeRotation {
 public:
  /// J about the mass centre, in the axes of the body.
  explicit FreeRotation(const Mat3& J);
  /// Turns e (body axes in the world) and w (rad/s, body axes) on by the time t, forward or back.
  void turn(double t, Quat& e, Vec3& w) const;

 private:
  void turn_about(int k, double t, Quat& e, Vec3& p) const;

  Quat axes_;  // principal axes in the body
  Vec3 J_;     // principal moments
};

}  // namespace lockstep
