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
inline MarkerInWorld in_world(const MarkerFrame& f, const Inputs& in) {
  const Motion& O = in.slot(f.slot);
  const MarkerMotion m = f.at(in.t);
  MarkerInWorld r;
  r.A = O.A * m.A;
  r.x = O.x + O.A * m.u;
  r.v = O.v + O.A * (cross(O.w, m.u) + m.ud);
  r.w = O.A * O.w + r.A * m.w;
  return r;
}

}  // namespace lockstep
