// What passes over MarkerLocks have in common, here and in copies/: the values of their laws.
#pragma once

#include "framework/mechanism/lock/marker_lock.h"

namespace lockstep {

struct MarkerLockGather {
  const Inputs& in;

  void both(const MarkerLock& first, Group links, RowSpan out) const;

  LawValue value(const MarkerLock& lock, const Drive& d) const {
    const LawValue l = d.law->at(in.t);
    if (!d.speed) return l;
    return {in.s[static_cast<std::size_t>(lock.first_state() + d.state)], l.y, l.yd};
  }

  ImposedTranslationT<double> imposed_translation(const MarkerLock& lock) const {
    ImposedTranslationT<double> D;
    if (lock.move_) {
      const TranslationValue l = lock.move_->at(in.t);
      D.p = l.x, D.pd = l.v, D.pdd = l.a;
    }
    for (const Drive& d : lock.drives_) {
      if (is_rotation(d.axis)) continue;
      const int k = index(d.axis);
      const LawValue l = value(lock, d);
      D.p[k] = l.y, D.pd[k] = l.yd, D.pdd[k] = l.ydd;
    }
    return D;
  }

  ImposedRotationT<double> imposed_rotation(const MarkerLock& lock) const {
    ImposedRotationT<double> D;
    if (lock.turn_) {
      const RotationValue l = lock.turn_->at(in.t);
      D.q = l.q, D.w = l.w, D.a = l.a;
    }
    for (const Drive& d : lock.drives_) {  // q_D <- q_D Rot_k(y): at most one, the other two turns being held
      if (!is_rotation(d.axis)) continue;
      const Vec3 n = Vec3::Unit(index(d.axis) % 3);
      const LawValue l = value(lock, d);
      const Quat turn = Quat::from(std::cos(0.5 * l.y), Vec3(std::sin(0.5 * l.y) * n));
      const Mat3 At = rotation(turn).transpose();
      const Vec3 w = At * D.w;
      D.a = At * D.a + cross(w, Vec3(l.yd * n)) + l.ydd * n;
      D.w = w + l.yd * n;
      D.q = D.q * turn;
    }
    D.A = rotation(D.q);
    return D;
  }

  template <unsigned kLaws>
  void translations(Group links, RowSpan out) const;
  template <unsigned kLaws>
  void rotations(Group links, RowSpan out) const;
  void in_plane(Group links, RowSpan out) const;
  void check_laws(const MarkerLock& lock) const;
};

}  // namespace lockstep
