// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/lock/stiffness.h"

namespace lockstep {

// (9.2)
void add_translation_stiffness(const Inputs& in, int slot1, int slot2, const MarkerMotion& P, const MarkerMotion& S,
                               const Vec3& lt, TangentSum& out) {
  const Motion &O1 = in.slot(slot1), &O2 = in.slot(slot2);
  const Vec3 n = S.A * lt, A2n = O2.A * n, g = O1.A.transpose() * A2n;
  const Vec3 s = vec::as<Vec3>(kernel::arm(kernel::body(O1), kernel::body(O2), vec::vector(P.u)));
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

// (9.3)
void add_rotation_stiffness(const Inputs& in, int slot1, int slot2, const MarkerMotion& P, const MarkerMotion& S,
                            const Quat& qD, const Quat& L, TangentSum& out) {
  const Mat3 A_SD = S.A * rotation(qD);
  const auto D = kernel::Turn{vec::quaternion(qD), vec::Identity{}, vec::None{}, vec::None{}};
  const auto error = kernel::rotation_error(kernel::body(in.slot(slot1)), kernel::body(in.slot(slot2)),
                                            kernel::marker<false, false>(P), kernel::marker<false, false>(S), D);
  const auto F = kernel::rotation_row(0.5 * error, vec::matrix(P.A), vec::matrix(A_SD), vec::quaternion(L));
  const Quat e = Quat::from(error.w, vec::as<Vec3>(error.v));
  const Vec3 ev = e.vec(), lr = L.vec();
  const Mat3 scalar = 0.25 * (e.w * L.w + ev.dot(lr)) * Mat3::Identity();
  out.add_K(slot1, Half::turn, slot1, Half::turn, 0.5 * skew(vec::as<Vec3>(F.w1)) - scalar);
  out.add_K(slot2, Half::turn, slot2, Half::turn, 0.5 * skew(vec::as<Vec3>(F.w2)) - scalar);
  const Mat3 X = 0.25 * (ev * lr.transpose() + lr * ev.transpose() - (ev.dot(lr) - e.w * L.w) * Mat3::Identity() -
                         skew(Vec3(e.w * lr + L.w * ev)));
  const Mat3 K12 = P.A * X * A_SD.transpose();
  out.add_K(slot1, Half::turn, slot2, Half::turn, K12);
  out.add_K(slot2, Half::turn, slot1, Half::turn, K12.transpose());
}

}  // namespace lockstep
