// Force 'force_motor': a force by a law between two bodies, along an axis.
#pragma once

#include <memory>

#include "framework/mechanism/forces/marker_force.h"

namespace lockstep {

/// Force F = law(t) along z of S on P's body at the origin of P, the opposite on S's body at the same point. Free to
/// move: only the force is given.
///
///   force    F = law(t)                                                           N, on P's body along z of S
///   rate     z_S.(v_P - v_S - w_S x (x_P - x_S)) of the markers                   m/s, of P along z in the axes of S
///   power    F z_S.(velocity of P's body at x_P - velocity of S's body at x_P)    W, put into the mechanism
/// No potential, no dissipation.
class LOCKSTEP_API ForceMotor final : public MarkerForce {
 public:
  struct Options {
    LawPtr<MotionLaw> force{};  ///< N; needed
  };
  /// Throws ParameterError (a ModelError) without a law.
  ForceMotor(std::string name, Marker& p, Marker& s, Options options);

  std::string_view type() const override { return info().name; }
  std::vector<Quantity> quantities() const override;  ///< force, rate, power
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
