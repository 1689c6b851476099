// Force 'applied_torque': a torque on a marker's body, constant or by laws.
#pragma once

#include <memory>

#include "framework/mechanism/forces/applied.h"

namespace lockstep {

/// Torque M on P's body; with S, -M on S's body.
///
///   M           value + law(t) direction + laws(t), in the axes chosen   N m
///   potential   none: a constant torque in space has none
///   power       M.(w of P's body - w of S's body)                        W
class LOCKSTEP_API AppliedTorque final : public Applied {
 public:
  struct Options {
    Vec3 torque = Vec3::Zero();               ///< N m
    LawPtr<MotionLaw> law{};                  ///< N m, about `direction`
    Vec3 direction = Vec3::Zero();            ///< any length but zero; needed with `law`
    std::array<LawPtr<MotionLaw>, 3> laws{};  ///< N m, the components
    AppliedAxes axes = AppliedAxes::world;
  };
  /// Throws ParameterError (a ModelError) for a number that cannot be.
  AppliedTorque(std::string name, Marker& p, Options options);
  AppliedTorque(std::string name, Marker& p, Marker& s, Options options);

  std::string_view type() const override { return info().name; }
  std::vector<Quantity> quantities() const override;  ///< torque_on_p_world_x, .._y, .._z, power
  double quantity(int k, const Inputs&) const override;
  double supply(const Inputs&) const override;
  void setup() override;
  void apply(const Inputs&, WrenchSum& out) const override;
  void tangent(const Inputs&, TangentSum& out) const override;

  static const TypeInfo& info();
  static std::unique_ptr<Force> make(const Site&, const Params&);
};

}  // namespace lockstep
