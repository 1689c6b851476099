// Forces 'force_motor' and 'torque_motor': a force or a torque by a law between two bodies, along an axis.
#pragma once

#include <memory>

#include "framework/mechanism/forces/effort.h"
#include "framework/mechanism/forces/formula_force.h"

namespace lockstep {

class Motor;
extern template class LOCKSTEP_API FormulaForce<Motor>;

/// What both motors are: the effort f = law(t) along z of S. Free to move: only the effort is given.
class LOCKSTEP_API Motor : public FormulaForce<Motor> {
 public:
  /// Throws ParameterError (a ModelError) without a law.
  Motor(std::string name, Marker& p, Marker& s, Effort effort, LawPtr<MotionLaw> law);
  ~Motor() override;
  std::vector<Quantity> quantities() const override;  ///< force or torque, rate, power
  void setup() override;
  template <class T, class Load>
  void act(const Ends<T>&, Load&) const;

 private:
  Effort effort_;
  LawPtr<MotionLaw> law_;
};

/// Force on P's body at the origin of P along z of S, the opposite on S's body at the same point.
///
///   force    F = law(t)                                                           N, on P's body along z of S
///   rate     z_S.(v_P - v_S - w_S x (x_P - x_S)) of the markers                   m/s, of P along z in the axes of S
///   power    F z_S.(velocity of P's body at x_P - velocity of S's body at x_P)    W, put into the mechanism
/// No potential, no dissipation.
class LOCKSTEP_API ForceMotor final : public Motor {
 public:
  struct Options {
    LawPtr<MotionLaw> force{};  ///< N; needed
  };
  /// Throws ParameterError (a ModelError) without a law.
  ForceMotor(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return info().name; }
  static const TypeInfo& info();
  static std::unique_ptr<Force> make(const Site&, const Params&);
};

/// Torque on P's body about z of S, the opposite on S's body.
///
///   torque   T = law(t)                        N m, on P's body about z of S
///   rate     z_S.(w_P - w_S) of the markers    rad/s
///   power    T z_S.(w_P - w_S) of the bodies   W, put into the mechanism
/// No potential, no dissipation.
class LOCKSTEP_API TorqueMotor final : public Motor {
 public:
  struct Options {
    LawPtr<MotionLaw> torque{};  ///< N m; needed
  };
  /// Throws ParameterError (a ModelError) without a law.
  TorqueMotor(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return info().name; }
  static const TypeInfo& info();
  static std::unique_ptr<Force> make(const Site&, const Params&);
};

}  // namespace lockstep
