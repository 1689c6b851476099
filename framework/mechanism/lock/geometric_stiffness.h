// Geometric stiffness of a lock: how its force Jh^T lambda changes with the poses, multipliers and laws fixed (theory,
// (9.2), (9.3)). Laws enter as numbers: all of them may be active, none costs anything extra.
#pragma once

#include "framework/mechanism/rows/tangent.h"
#include "framework/mechanism/lock/kernel.h"
#include "framework/mechanism/lock/look.h"

namespace lockstep {

/// (9.2) Translational rows; lt: multipliers of x, y, z (S axes), zero where there is no row.
///
///   n = A_S lt (O2 axes),  A2 n (world),  g = A1^T A2 n (O1 axes)         F = ( A2 n | uP x g | -A2 n | n x s )
inline void add_translation_stiffness(const Inputs& in, int slot1, int slot2, const MarkerMotion& P,
                                      const MarkerMotion& S, const Vec3& lt, TangentSum& out) {
  const Motion &O1 = in.slot(slot1), &O2 = in.slot(slot2);
  const Vec3 n = S.A * lt, A2n = O2.A * n, g = O1.A.transpose() * A2n;
  const Vec3 s = O2.A.transpose() * (O1.x + O1.A * P.u - O2.x);
  const Mat3 A2_n = O2.A * skew(n), uP = skew(P.u), turned = uP * O1.A.transpose() * A2_n;
  Mat6 K = Mat6::Zero();
  K.block<3, 3>(3, 3) = uP * skew(g);
  out.add_K(slot1, slot1, K);
  K.block<3, 3>(3, 3) = -turned;
  K.block<3, 3>(0, 3) = -A2_n;
  out.add_K(slot1, slot2, K);
  out.add_K(slot2, slot1, K.transpose());
  K.block<3, 3>(0, 3) = A2_n;
  K.block<3, 3>(3, 0) = A2_n.transpose();
  K.block<3, 3>(3, 3) = skew(n) * skew(s);
  out.add_K(slot2, slot2, K);
}

/// (9.3) Rotational rows; L: multipliers (l0, lr) of the four components of e; l0 = 0 for a lock, whose rows are
/// vec(e). qD, A_D: the imposed rotation.
///
///   F_th1 = +(1/2) A_P ( e0 lr - l0 ev - ev x lr )          F_th2 = -(1/2) A_SD ( e0 lr - l0 ev + ev x lr )
inline void add_rotation_stiffness(const Inputs& in, int slot1, int slot2, const MarkerMotion& P, const MarkerMotion& S,
                                   const Quat& qD, const Quat& L, TangentSum& out) {
  const Quat e = conjugate(in.slot(slot2).e * S.q * qD) * (in.slot(slot1).e * P.q);
  const Vec3 ev = e.vec(), lr = L.vec(), even = e.w * lr - L.w * ev, odd = cross(ev, lr);
  const Mat3 A_SD = S.A * rotation(qD);
  const Mat3 scalar = 0.25 * (e.w * L.w + ev.dot(lr)) * Mat3::Identity();
  out.add_K(slot1, Half::turn, slot1, Half::turn, 0.25 * skew(Vec3(P.A * (even - odd))) - scalar);
  out.add_K(slot2, Half::turn, slot2, Half::turn, -0.25 * skew(Vec3(A_SD * (even + odd))) - scalar);
  const Mat3 X = 0.25 * (ev * lr.transpose() + lr * ev.transpose() - (ev.dot(lr) - e.w * L.w) * Mat3::Identity() -
                         skew(Vec3(e.w * lr + L.w * ev)));
  const Mat3 K12 = P.A * X * A_SD.transpose();
  out.add_K(slot1, Half::turn, slot2, Half::turn, K12);
  out.add_K(slot2, Half::turn, slot1, Half::turn, K12.transpose());
}

}  // namespace lockstep
