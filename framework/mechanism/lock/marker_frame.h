// MarkerFrame: a marker folded into its slot, so that kernels see slots only and need no special case for bodies that
// share one or that are fixed.
#pragma once

#include "framework/mechanism/lock/kernel.h"
#include "framework/mechanism/model/marker.h"

namespace lockstep {

struct MarkerFrame {
  int slot = kGround;
  Vec3 u0 = Vec3::Zero();  ///< home origin in the slot, m
  Quat q0;                 ///< home axes -> slot axes
  Mat3 A0 = Mat3::Identity();
  LawPtr<TranslationLaw> slide;  // shared, so that a marker whose law is replaced later leaves nothing dangling
  LawPtr<RotationLaw> spin;
  MarkerMotion home;  ///< at(t) of a marker without laws

  MarkerFrame() = default;
  explicit MarkerFrame(const Marker& m) : slot(m.body->slot), slide(m.slide), spin(m.spin) {
    const Pose pose = m.body->in_slot * m.local;
    u0 = pose.x, q0 = normalized(pose.q), A0 = rotation(q0);
    home.u = u0, home.q = q0, home.A = A0;
  }

  /// Axes of the slot, with q0 = +1: q0 = -1 is the same turn, but gives e the other sign.
  bool parallel() const { return !slide && !spin && q0.w > 0 && A0.isApprox(Mat3::Identity(), 1e-15); }

  /// Origin, axes and their rates at time t: u = u0 + A0 x(t), q = q0 q(t).
  MarkerMotion at(double t) const {
    MarkerMotion m;
    m.u = u0, m.q = q0, m.A = A0;
    if (slide) {
      const TranslationValue l = slide->at(t);
      m.u += A0 * l.x, m.ud = A0 * l.v, m.udd = A0 * l.a;
    }
    if (spin) {
      const RotationValue l = spin->at(t);
      m.q = q0 * l.q, m.A = rotation(m.q), m.w = l.w, m.a = l.a;
    }
    return m;
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const {
    if (slide) slide->breakpoints(t0, t1, out);
    if (spin) spin->breakpoints(t0, t1, out);
  }
};

/// Motion of a marker in the world: x, v, A (marker axes -> world), w in world axes.
struct MarkerInWorld {
  Vec3 x, v, w;
  Mat3 A;
};
/// A marker on its slot at one instant, on any scalar; each quantity is computed when asked for.
template <class T>
struct MarkerOn {
  const MotionT<T>& slot;
  MarkerMotion marker;

  Mat3T<T> A() const { return slot.A * marker.A; }                         ///< marker axes -> world
  Vec3T<T> axis(int k) const { return slot.A * marker.A.col(k); }          ///< column k of A
  Vec3T<T> x() const { return slot.x + slot.A * marker.u; }                ///< origin, world, m
  Vec3T<T> v() const { return slot.v + slot.A * (cross(slot.w, marker.u) + marker.ud); }  ///< its velocity, m/s
  Vec3T<T> w() const { return slot.A * (slot.w + marker.A * marker.w); }   ///< angular velocity, world, rad/s
  QuatT<T> q() const { return slot.e * QuatT<T>{marker.q.w, marker.q.x, marker.q.y, marker.q.z}; }
  /// Velocity (world) of the point of the slot that is at x now.
  Vec3T<T> slot_velocity(const Vec3T<T>& at) const { return slot.v + cross(slot_rate(), Vec3T<T>(at - slot.x)); }
  /// Angular velocity of the slot, world axes.
  Vec3T<T> slot_rate() const { return slot.A * slot.w; }
};
inline MarkerInWorld in_world(const MarkerFrame& f, const Inputs& in) {
  const MarkerOn<double> m{in.slot(f.slot), f.at(in.t)};
  return {m.x(), m.v(), m.w(), m.A()};
}

}  // namespace lockstep
