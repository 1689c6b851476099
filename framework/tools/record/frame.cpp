#include "framework/tools/record/frame.h"

namespace lockstep::channels {
namespace {

Vec3 slot_acceleration(const VecX& a, int slot) {
  return slot == kGround ? Vec3(Vec3::Zero()) : Vec3(a.segment<3>(6 * slot));
}
Vec3 slot_alpha(const VecX& a, int slot) {
  return slot == kGround ? Vec3(Vec3::Zero()) : Vec3(a.segment<3>(6 * slot + 3));
}

}  // namespace

MarkerFrame Frame::folded() const {
  if (marker) return MarkerFrame(*marker);
  MarkerFrame f;
  f.slot = body->slot;
  const Pose& p = body->fixed ? body->home : body->in_slot;
  f.u0 = p.x, f.q0 = normalized(p.q), f.A0 = rotation(f.q0);
  return f;
}

const MarkerFrame& Frame::in(const System& system) const {
  if (revision != system.revision()) last = folded(), revision = system.revision();
  return last;
}

FrameMotion motion_of(const Frame& frame, const Sample& sample) {
  const MarkerFrame& f = frame.in(sample.system());
  const Motion& O = sample.inputs().slot(f.slot);
  const MarkerMotion m = f.at(sample.state.t);
  FrameMotion r;
  r.q = O.e * m.q;
  r.A = O.A * m.A;
  r.x = O.x + O.A * m.u;
  r.v = O.v + O.A * (cross(O.w, m.u) + m.ud);
  r.w = O.A * O.w + r.A * m.w;
  return r;
}

FrameAcceleration acceleration_of(const Frame& frame, const Sample& sample) {
  const VecX& a = sample.accelerations();
  const MarkerFrame& f = frame.in(sample.system());
  const Motion& O = sample.inputs().slot(f.slot);
  const MarkerMotion m = f.at(sample.state.t);
  const Vec3 al = slot_alpha(a, f.slot);
  // a = a_O + A (al x u + w x (w x u + 2 ud) + udd),  alpha = A al + A_M md + (A w) x (A_M mw)
  FrameAcceleration r;
  r.a = slot_acceleration(a, f.slot) + O.A * (cross(al, m.u) + cross(O.w, Vec3(cross(O.w, m.u) + 2.0 * m.ud)) + m.udd);
  r.alpha = O.A * (al + m.A * m.a + cross(O.w, Vec3(m.A * m.w)));
  return r;
}

Relative relative(const Frame& m, const Frame& n, const Sample& sample) {
  const FrameMotion P = motion_of(m, sample), S = motion_of(n, sample);
  const Mat3 to_n = S.A.transpose();
  const Vec3 x = P.x - S.x;
  return {to_n * x, to_n * (P.v - S.v - cross(S.w, x)), to_n * (P.w - S.w), conjugate(S.q) * P.q};
}

// In the axes of n, which turn with w_n:
//   x'' = a_m - a_n - alpha_n x r - w_n x (w_n x r) - 2 w_n x v,  w' = alpha_m - alpha_n - w_n x w
Relative relative_with_second(const Frame& m, const Frame& n, const Sample& sample) {
  Relative r = relative(m, n, sample);
  const FrameAcceleration P = acceleration_of(m, sample), S = acceleration_of(n, sample);
  const FrameMotion N = motion_of(n, sample);
  const Mat3 to_n = N.A.transpose();
  const Vec3 w = to_n * N.w;
  r.a = to_n * (P.a - S.a) - cross(Vec3(to_n * S.alpha), r.x) - cross(w, Vec3(cross(w, r.x) + 2.0 * r.v));
  r.alpha = to_n * (P.alpha - S.alpha) - cross(w, r.w);
  return r;
}

}  // namespace lockstep::channels
