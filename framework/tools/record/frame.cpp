// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/record/frame.h"

namespace lockstep::channels {

const MarkerFrame& Frame::in(const System& system) const {
  if (revision != system.revision()) last = folded(), revision = system.revision();
  return last;
}

namespace {

Relative values_of(const Vec7T<double>& y, const Vec7T<double>& yd) {
  return {.x = y.head<3>(), .v = yd.head<3>(), .e = Quat::from(y.tail<4>()), .ed = Quat::from(yd.tail<4>())};
}

bool has_laws(const MarkerFrame& m) { return m.translation_law || m.rotation_law; }

}  // namespace

Relative relative(const Frame& m, const Frame& n, const Sample& sample) {
  const MarkerFrame &P = m.in(sample.system()), &S = n.in(sample.system());
  const auto read = [](const auto& pair) { return values_of(pair.y(), pair.yd()); };
  return has_laws(P) || has_laws(S) ? read(MovingPair<Reads::both>(P, S, sample.inputs()))
                                    : read(StillPair<Reads::both>(P, S, sample.inputs()));
}

// ydd = Jh acc - Qhat
Relative relative_with_second(const Frame& m, const Frame& n, const Sample& sample) {
  const VecX& acc = sample.accelerations();
  const auto part = [&](const MarkerFrame& f, int first) {
    return f.slot == kGround ? Vec3(Vec3::Zero()) : Vec3(acc.segment<3>(6 * f.slot + first));
  };
  const MarkerFrame &P = m.in(sample.system()), &S = n.in(sample.system());
  const double t = sample.state.t;
  const RelativeKinematics k =
      relative_kinematics(sample.inputs().slot(P.slot), sample.inputs().slot(S.slot), P.at(t), S.at(t),
                          has_laws(P) || has_laws(S) ? with::all_laws : with::nothing);
  const Vec7T<double> ydd = k.Jv1 * (part(P, 0) - part(S, 0)) + k.Jw1 * part(P, 3) + k.Jw2 * part(S, 3) - k.Qhat;
  Relative r = values_of(k.y, k.yd);
  r.a = ydd.head<3>(), r.edd = Quat::from(ydd.tail<4>());
  return r;
}

}  // namespace lockstep::channels
