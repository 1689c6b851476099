// Force 'applied_force': a force at a marker, constant or by laws.
#pragma once

#include <memory>

#include "framework/mechanism/forces/applied.h"

namespace lockstep {

/// Force F at the origin of P on P's body; with S, -F on S's body at the same point.
///
///   F           value + law(t) direction + laws(t), in the axes chosen                            N
///   potential   V = -value.x_P, only of the constant part in world axes, without S or with S on the ground   J
///   power       F.(velocity of P's body at x_P - velocity of S's body at x_P)                     W
class LOCKSTEP_API AppliedForce final : public Applied {
 public:
  struct Options {
    Vec3 force = Vec3::Zero();                ///< N
    LawPtr<MotionLaw> law{};                  ///< N, along `direction`
    Vec3 direction = Vec3::Zero();            ///< any length but zero; needed with `law`
    std::array<LawPtr<MotionLaw>, 3> laws{};  ///< N, the components
    AppliedAxes axes = AppliedAxes::world;
  };
  /// Throws ParameterError (a ModelError) for a number that cannot be.
  AppliedForce(std::string name, Marker& p, Options options);
  AppliedForce(std::string name, Marker& p, Marker& s, Options options);

  std::string_view type() const override { return info().name; }
  std::vector<Quantity> quantities() const override;  ///< force_on_p_world_x, .._y, .._z, power
  double quantity(int k, const Inputs&) const override;
  double supply(const Inputs&) const override;
  void setup() override;
  void apply(const Inputs&, WrenchSum& out) const override;
  void tangent(const Inputs&, TangentSum& out) const override;
  double potential(const Inputs&) const override;

  static const TypeInfo& info();
  static std::unique_ptr<Force> make(const Site&, const Params&);
};

}  // namespace lockstep
