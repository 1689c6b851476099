// Force 'spring_damper': spring, damper and linear actuator between two points.
#pragma once

#include <memory>

#include "framework/mechanism/forces/formula_force.h"

namespace lockstep {

class SpringDamper;
extern template class LOCKSTEP_API FormulaForce<SpringDamper>;

/// Spring and damper on the line between the origins of P and S; pulls P and S together when its force is positive.
///
///   length      l = |x_P - x_S|                                   m
///   rate        ld = n.(v_P - v_S),   n = (x_P - x_S)/l           m/s
///   force       T = k (l - l0) + T0 + c ld + law(t)               N, positive = pulls; -T n on P, +T n on S
///   potential   V = 1/2 k (l - l0)^2 + T0 (l - l0)                J
///   dissipation D = c ld^2                                        W
///   power       T n.(v_S - v_P) of the two bodies                 W; = -dV/dt - D - law ld, markers still
///
/// With l = 0 there is no direction and so no force; setup() refuses markers that coincide at the start unless the
/// force is zero there. k may be negative (a spring that pushes away); c and l0 may not. Moving markers: x and v are
/// theirs.
class LOCKSTEP_API SpringDamper final : public FormulaForce<SpringDamper> {
 public:
  struct Options {
    double stiffness = 0;       ///< k, N/m
    double damping = 0;         ///< c, N s/m, not negative
    double free_length = 0;     ///< l0, m, not negative
    double preload = 0;         ///< T0, N: force at l0, positive = pulls
    LawPtr<MotionLaw> force{};  ///< N, added to the force: a linear actuator
  };
  /// Throws ParameterError (a ModelError) for a number that cannot be.
  SpringDamper(std::string name, Marker& p, Marker& s, Options options);

  std::string_view type() const override { return info().name; }
  std::vector<Quantity> quantities() const override;  ///< length, rate, force, power
  void setup() override;
  template <class T, class Load>
  void act(const Ends<T>&, Load&) const;

  static const TypeInfo& info();
  static std::unique_ptr<Force> make(const Site&, const Params&);

 private:
  Options options_;
};

}  // namespace lockstep
