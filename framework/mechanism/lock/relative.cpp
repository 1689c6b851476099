// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/relative.h>

namespace lockstep {

template RelativeKinematics relative_kinematics(const Motion&, const Motion&, const MarkerMotion&, const MarkerMotion&,
                                                unsigned, Reads);

MarkerFrame::MarkerFrame(const Marker& m)
    : slot(m.body->slot), translation_law(m.translation_law), rotation_law(m.rotation_law) {
  const Pose pose = m.body->in_slot * m.local;
  u0 = pose.x, q0 = normalized(pose.q), A0 = rotation(q0);
  home.u = u0, home.q = q0, home.A = A0;
}

bool MarkerFrame::stays_in_plane(Plane plane) const {
  const Vec3 normal = A0.row(plane.n);
  return (!translation_law || translation_law->stays_in_plane(normal)) &&
         (!rotation_law || rotation_law->turns_about(normal));
}

void MarkerFrame::breakpoints(double t0, double t1, std::vector<double>& out) const {
  if (translation_law) translation_law->breakpoints(t0, t1, out);
  if (rotation_law) rotation_law->breakpoints(t0, t1, out);
}

bool MarkerFrame::parallel() const {
  return !translation_law && !rotation_law && q0.w > 0 && A0.isApprox(Mat3::Identity(), 1e-15);
}

MarkerInWorld in_world(const MarkerFrame& f, const Inputs& in) {
  const MarkerOn<double> m = marker_on(f, in);
  return {m.x(), m.v(), m.w(), m.A()};
}

}  // namespace lockstep
