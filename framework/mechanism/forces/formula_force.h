// SPDX-License-Identifier: BSD-3-Clause
// The force 'function_force': a formula of one coordinate of P seen from S, its rate and the time, written in a scene.
#pragma once

#include <lockstep/author/force.h>
#include <lockstep/author/formula.h>
#include <lockstep/author/params.h>
#include <lockstep/detail/counted_angle.h>
#include <lockstep/forces.h>
#include "framework/mechanism/expression/function.h"

namespace lockstep {

class CoordinateForce;
extern template class LOCKSTEP_API FormulaForce<CoordinateForce>;

/// Force f(q, qd, t) along an axis of S, or torque about it.
///
///     force   q = a.(x_P - x_S), a an axis of S                m; f a on P's body at P, -f a on S's body at the same point
///     torque  q = 2 atan2(e_k, e0), full turns counted         rad; f g on P, -f g on S, g the gradient of q
///     power   f qd, all of it supply                           W
///
/// No potential: what the formula stores or dissipates is not known.
class LOCKSTEP_API CoordinateForce final : public FormulaForce<CoordinateForce> {
 public:
  /// `axis` rx, ry, rz: a torque. Throws ModelError as MarkerForce does.
  CoordinateForce(std::string name, Marker& p, Marker& s, Axis axis, expression::FormulaFunction f);
  std::string_view type() const override { return info().name; }
  std::vector<Quantity> quantities() const override;  ///< coordinate, rate, force (torque), power
  void setup() override;
  bool stays_in_plane(Plane) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  template <class T, class Load>
  void act(const Ends<T>&, Load&) const;

  /// That of a torque.
  void count_angles(AngleCounter&) override;

  static const TypeInfo& info();                                         ///< name and keys of its type
  static std::unique_ptr<Force> make(const Attachment&, const Params&);  ///< the force from checked parameters

 private:
  Axis axis_;
  expression::FormulaFunction f_;
  const CountedAngle* angle_ = nullptr;  // of a torque; null where no system counts it
};

}  // namespace lockstep
