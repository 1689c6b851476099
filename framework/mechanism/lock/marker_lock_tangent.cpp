#include <cmath>

#include "framework/mechanism/lock/geometric_stiffness.h"
#include "framework/mechanism/lock/marker_lock.h"

namespace lockstep {

// q_D: the imposed rotation, then the driven turn (at most one).
Quat MarkerLock::imposed_turn(const Inputs& in) const {
  Quat q = turn_ ? turn_->at(in.t).q : Quat{};
  for (const Drive& d : drives_) {
    if (!is_rotation(d.axis)) continue;
    const double y = d.speed ? in.s[static_cast<std::size_t>(first_state() + d.state)] : d.law->at(in.t).y;
    q = q * Quat::from(std::cos(0.5 * y), Vec3(std::sin(0.5 * y) * Vec3::Unit(index(d.axis) % 3)));
  }
  return q;
}

void MarkerLock::tangent(const Inputs& in, std::span<const double> lambda, TangentSum& out) const {
  Vec3 lt = Vec3::Zero(), lr = Vec3::Zero();
  for (int k = 0; k < n_rows_; ++k) {
    const int j = row_[static_cast<std::size_t>(k)];
    (j < 3 ? lt[j] : lr[j - 3]) = lambda[static_cast<std::size_t>(k)];
  }
  const MarkerMotion P = P_.at(in.t), S = S_.at(in.t);
  if (any(rows_, Mask::xyz)) add_translation_stiffness(in, P_.slot, S_.slot, P, S, lt, out);
  if (any(rows_, Mask::e123))
    add_rotation_stiffness(in, P_.slot, S_.slot, P, S, imposed_turn(in), Quat::from(0.0, lr), out);
}

}  // namespace lockstep
