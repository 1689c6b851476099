// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/lock.h>
#include "framework/mechanism/lock/stiffness.h"

namespace lockstep {

void MarkerLock::tangent(const Inputs& in, std::span<const double> lambda, TangentSum& out) const {
  Vec3 lt = Vec3::Zero(), lr = Vec3::Zero();
  for (int k = 0; k < n_rows_; ++k) {
    const int j = static_cast<unsigned char>(row_[k]);
    (j < 3 ? lt[j] : lr[j - 3]) = lambda[k];
  }
  const MarkerMotion P = P_at(in.t), S = S_at(in.t);
  if (overlaps(rows_, Mask::xyz)) add_translation_stiffness(in, slot1_, slot2_, P, S, lt, out);
  if (overlaps(rows_, Mask::e123))
    add_rotation_stiffness(in, slot1_, slot2_, P, S, imposed_rotation(in).q, Quat::from(0.0, lr), out);
}

}  // namespace lockstep
