// BodyMass: the mass matrix of one slot in its unknowns: v (world) and w (slot axes) of a body, v alone of a particle;
// in a plane the two or three velocities of it.
#pragma once

#include "framework/foundation/support/export.h"
#include "framework/mechanism/model/plane.h"
#include "framework/mechanism/model/slot.h"

namespace lockstep {

class LOCKSTEP_API BodyMass {
 public:
  BodyMass() = default;
  BodyMass(double m, const Mat3& J, bool particle, Plane plane = {});
  BodyMass(const Slot& slot, Plane plane) : BodyMass(slot.mass, slot.J, slot.freedoms == Freedoms::particle, plane) {}

  double m() const { return m_; }
  /// Inertia in slot axes, and its inverse: zero of a particle, which does not turn.
  const Mat3& J() const { return J_; }
  const Mat3& inverse_J() const { return inverse_J_; }
  int width() const { return plane_ ? (particle_ ? 2 : 3) : (particle_ ? 3 : 6); }

  /// M and its inverse as blocks of width x width.
  void write_blocks(double* M, double* inverse) const;
  /// The same as m, Jxx, Jxy, Jxz, Jyy, Jyz, Jzz; in a plane as m and J about its normal.
  void write_packed(double* M, double* inverse) const;
  /// y += M x, six numbers each.
  template <class X, class Y>
  void add_times(const X& x, Y&& y) const {
    y.template head<3>() += m_ * x.template head<3>();
    y.template tail<3>() += J_ * x.template tail<3>();
  }

 private:
  double m_ = 0;
  Mat3 J_ = Mat3::Zero(), inverse_J_ = Mat3::Zero();
  bool particle_ = false;
  Plane plane_;
};

/// Which of the six velocities of a slot its unknowns are.
inline std::array<int, 6> unknown_velocities(Plane plane) {
  if (plane) return {plane.velocity(0), plane.velocity(1), plane.velocity(2)};
  return {0, 1, 2, 3, 4, 5};
}

}  // namespace lockstep
