// WrenchSum: adds the forces on each slot, in the coordinates of the equations of motion (theory, (2.5), (2.9)).
#pragma once

#include <span>

#include "framework/mechanism/model/inputs.h"

namespace lockstep {

/// f: 6 a slot: force (world) at the slot's origin, moment about it (slot axes). The ground takes anything silently.
class WrenchSum {
 public:
  WrenchSum(std::span<const Motion> motions, VecX& f) : motions_(motions), f_(f) {}

  /// Force F (world, N) acting at the point x (world, m).
  void force(int slot, const Vec3& F, const Vec3& x) const {
    if (slot == kGround) return;
    const Motion& O = motion(slot);
    f_.segment<3>(6 * slot) += F;
    f_.segment<3>(6 * slot + 3) += O.A.transpose() * cross(Vec3(x - O.x), F);
  }
  /// Free moment (world axes, N m).
  void torque(int slot, const Vec3& tau) const {
    if (slot == kGround) return;
    f_.segment<3>(6 * slot + 3) += motion(slot).A.transpose() * tau;
  }
  /// Generalised force along a row: v and w parts as in a jacobian (world, slot axes).
  void along(int slot, const Vec3& v, const Vec3& w) const {
    if (slot == kGround) return;
    f_.segment<3>(6 * slot) += v;
    f_.segment<3>(6 * slot + 3) += w;
  }

 private:
  const Motion& motion(int slot) const { return motions_[static_cast<std::size_t>(slot + 1)]; }
  std::span<const Motion> motions_;
  VecX& f_;
};

}  // namespace lockstep
