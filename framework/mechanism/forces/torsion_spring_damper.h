// Force 'torsion_spring_damper': spring, damper and rotary actuator about an axis, its turns counted.
#pragma once

#include <memory>

#include "framework/mechanism/forces/formula_force.h"

namespace lockstep {

class TorsionSpringDamper;
extern template class LOCKSTEP_API FormulaForce<TorsionSpringDamper>;

/// Spring and damper about the common z axis of P and S; turns P back when its torque is positive.
///
///   angle       th = 2 atan2(e3, e0), e = q_S' q_P, counted past full turns   rad
///   rate        thd = g.(w_P - w_S), g = (z_P + z_S)/(1 + z_P.z_S)            rad/s; g = z where the axes are common
///   torque      T = k (th - th0) + T0 + c thd + law(t)                        N m; -T g on P, +T g on S
///   potential   V = 1/2 k (th - th0)^2 + T0 (th - th0)                        J
///   dissipation D = c thd^2                                                   W
///   power       T g.(w_S - w_P) of the two bodies                             W; = -dV/dt - D - law thd, markers still
///
/// g is the gradient of th, so that the power balance holds for axes that are not quite common too. The angle starts in
/// (-pi, pi] and takes the branch nearest to the last accepted one (one number of State::z): a step may turn by less
/// than half a turn. Where z_P = -z_S there is no angle and no torque; setup() refuses such a start. k may be negative,
/// c not.
class LOCKSTEP_API TorsionSpringDamper final : public FormulaForce<TorsionSpringDamper>, public Remembering {
 public:
  struct Options {
    double stiffness = 0;        ///< k, N m/rad
    double damping = 0;          ///< c, N m s/rad, not negative
    double free_angle = 0;       ///< th0, rad; more than a turn winds the spring up
    double preload = 0;          ///< T0, N m: torque at th0
    LawPtr<MotionLaw> torque{};  ///< N m, added to the torque
  };
  /// Throws ParameterError (a ModelError) for a number that cannot be.
  TorsionSpringDamper(std::string name, Marker& p, Marker& s, Options options);

  std::string_view type() const override { return info().name; }
  std::vector<Quantity> quantities() const override;  ///< angle, rate, torque, power
  void setup() override;
  template <class T, class Load>
  void act(const Ends<T>&, Load&) const;

  const Remembering* remembering() const override { return this; }
  int n_memory() const override { return 1; }  ///< z[0]: the counted angle
  void start_memory(std::span<double> z) const override { z[0] = 0; }
  void accept_step(const Inputs& in, std::span<double> z) const override { z[0] = quantity(0, in); }

  static const TypeInfo& info();
  static std::unique_ptr<Force> make(const Site&, const Params&);

 private:
  Options options_;
};

}  // namespace lockstep
