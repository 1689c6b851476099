// Force 'torque_motor': a torque by a law between two bodies, about an axis.
#pragma once

#include <memory>

#include "framework/mechanism/forces/marker_force.h"

namespace lockstep {

/// Torque T = law(t) about z of S on P's body, the opposite on S's body. Free to move: only the torque is given.
///
///   torque   T = law(t)                                   N m, on P's body about z of S
///   rate     z_S.(w_P - w_S) of the markers               rad/s
///   power    T z_S.(w_P - w_S) of the bodies              W, put into the mechanism; no potential, no dissipation
class LOCKSTEP_API TorqueMotor final : public MarkerForce {
 public:
  struct Options {
    LawPtr<MotionLaw> torque{};  ///< N m; needed
  };
  /// Throws ParameterError (a ModelError) without a law.
  TorqueMotor(std::string name, Marker& p, Marker& s, Options options);

  std::string_view type() const override { return info().name; }
  std::vector<Quantity> quantities() const override;  ///< torque, rate, power
  double quantity(int k, const Inputs&) const override;
  double supply(const Inputs&) const override;
  void setup() override;
  void apply(const Inputs&, WrenchSum& out) const override;
  void tangent(const Inputs&, TangentSum& out) const override;

  static const TypeInfo& info();
  static std::unique_ptr<Force> make(const Site&, const Params&);

 private:
  Options options_;
};

}  // namespace lockstep
