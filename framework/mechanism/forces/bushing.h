// Force 'bushing': a soft joint, linear in six directions.
#pragma once

#include <memory>

#include "framework/mechanism/forces/formula_force.h"

namespace lockstep {

class Bushing;
extern template class LOCKSTEP_API FormulaForce<Bushing>;

/// Springs and dampers along and about the axes of S, between P and S. d = A_S' (x_P - x_S); th = rotation vector of
/// e = q_S' q_P in the axes of S, |th| < pi: small turns.
///
///   force       F = -(K d + C dd),      dd = A_S' (v_P - v_S) - w_S x d       N, S axes; on P's body at x_P, -F on S's
///   torque      M = -(J' Kt th + Ct w),  w = A_S' (w_P - w_S), thd = J w      N m, S axes; on P's body, -M on S's
///               J = 1 - 1/2 th~ + c th~^2,  c = (1 - (a/2) cot(a/2))/a^2,  a = |th|
///   potential   V = 1/2 d'K d + 1/2 th'Kt th                                  J
///   dissipation D = dd'C dd + w'Ct w                                          W
///   power       of F and M on the two bodies                                  W; = -dV/dt - D, markers still
///
/// With J the power balance is exact, not only for small turns; J' Kt th = Kt th for equal stiffnesses. S may not be on
/// a particle; P may, when the rotational numbers are zero. Stiffness may be negative, damping not.
class LOCKSTEP_API Bushing final : public FormulaForce<Bushing> {
 public:
  struct Options {
    Vec3 stiffness = Vec3::Zero();          ///< K, N/m, along the axes of S
    Vec3 damping = Vec3::Zero();            ///< C, N s/m
    Vec3 torsion_stiffness = Vec3::Zero();  ///< Kt, N m/rad, about the axes of S
    Vec3 torsion_damping = Vec3::Zero();    ///< Ct, N m s/rad
  };
  /// Throws ParameterError (a ModelError) for a number that cannot be.
  Bushing(std::string name, Marker& p, Marker& s, Options options);

  std::string_view type() const override { return info().name; }
  /// x y z (d), angle_x angle_y angle_z (th), force_on_p_link_x .. z, torque_on_p_link_x .. z (S axes), power
  std::vector<Quantity> quantities() const override;
  void setup() override;
  template <class T, class Load>
  void act(const Ends<T>&, Load&) const;

  static const TypeInfo& info();
  static std::unique_ptr<Force> make(const Site&, const Params&);

 private:
  Options options_;
};

}  // namespace lockstep
