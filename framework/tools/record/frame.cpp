#include "framework/tools/record/frame.h"

namespace lockstep::channels {
namespace {

Vec3 slot_acceleration(const VecX& a, int slot) {
  return slot == kGround ? Vec3(Vec3::Zero()) : Vec3(a.segment<3>(6 * slot));
}
Vec3 slot_alpha(const VecX& a, int slot) {
  return slot == kGround ? Vec3(Vec3::Zero()) : Vec3(a.segment<3>(6 * slot + 3));
}

RelativeKinematics kinematics_of(const MarkerFrame& m, const MarkerFrame& n, const Inputs& in) {
  const bool moving = m.translation_law || m.rotation_law || n.translation_law || n.rotation_law;
  return relative_kinematics(in.slot(m.slot), in.slot(n.slot), m.at(in.t), n.at(in.t), moving ? 1u : 0u);
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
  const VecX& a = sample.values().a;
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

namespace {

Relative relative(const RelativeKinematics& L, const MarkerFrame& P, const MarkerFrame& S, const Inputs& in) {
  Relative r;
  r.y = L.y, r.yd = L.yd, r.ydd.setZero();
  const MarkerOn<double> p{in.slot(P.slot), P.at(in.t)}, s{in.slot(S.slot), S.at(in.t)};
  r.w = s.A().transpose() * (p.w() - s.w());
  return r;
}

}  // namespace

Relative relative(const Frame& m, const Frame& n, const Sample& sample) {
  const MarkerFrame &P = m.in(sample.system()), &S = n.in(sample.system());
  const Inputs& in = sample.inputs();
  return relative(kinematics_of(P, S, in), P, S, in);
}

Relative relative_with_second(const Frame& m, const Frame& n, const Sample& sample) {
  const VecX& a = sample.values().a;
  const MarkerFrame &P = m.in(sample.system()), &S = n.in(sample.system());
  const RelativeKinematics L = kinematics_of(P, S, sample.inputs());
  Relative r = relative(L, P, S, sample.inputs());
  // (2.2) ydd = Jh_y acc - Qhat_y
  r.ydd = L.Jv1 * (slot_acceleration(a, P.slot) - slot_acceleration(a, S.slot)) + L.Jw1 * slot_alpha(a, P.slot) +
          L.Jw2 * slot_alpha(a, S.slot) - L.Qhat;
  return r;
}

}  // namespace lockstep::channels
