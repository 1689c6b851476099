// Forces 'applied_force' and 'applied_torque': a force at a marker or a torque on its body, constant or by laws.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "framework/mechanism/forces/effort.h"
#include "framework/mechanism/forces/formula_force.h"

namespace lockstep {

/// The axes in which an applied vector is given: the world's, those of P's body, or those of marker P.
enum class AppliedAxes { world, body, marker };

/// value + law(t) direction + (laws_x, laws_y, laws_z)(t); what is left out is zero.
struct AppliedVector {
  Vec3 value = Vec3::Zero();                ///< N or N m
  LawPtr<MotionLaw> law{};                  ///< N or N m, along `direction`
  Vec3 direction = Vec3::Zero();            ///< any length but zero; needed with `law`
  std::array<LawPtr<MotionLaw>, 3> laws{};  ///< N or N m, the three components
  AppliedAxes axes = AppliedAxes::world;
};

class Applied;
extern template class LOCKSTEP_API FormulaForce<Applied>;

/// What both applied loads are: the effort of a vector on P's body; with S, the opposite on S's body.
class LOCKSTEP_API Applied : public FormulaForce<Applied> {
 public:
  /// Throws ParameterError (a ModelError) for a number that cannot be.
  Applied(std::string name, Marker& p, Marker* s, Effort effort, AppliedVector vector);
  ~Applied() override;
  /// force_on_p_world_x, .._y, .._z (of a torque: torque_..), power
  std::vector<Quantity> quantities() const override;
  void setup() override;
  template <class T, class Load>
  void act(const Ends<T>&, Load&) const;

 protected:
  static Keys keys(Effort);
  /// The vector that `keys` describe. Throws SceneError.
  static AppliedVector read(Effort, const Params&);

 private:
  Vec3 in_its_axes(double t) const;
  Effort effort_;
  AppliedVector vector_;
  Mat3 body_axes_ = Mat3::Identity();  // body axes -> slot axes; made by setup()
};

/// Force F at the origin of P on P's body; with S, -F on S's body at the same point.
///
///   force       F = value + law(t) direction + laws(t), in the axes chosen          N
///   potential   V = -value.x_P, only of the constant part in world axes, without S or with S on the ground   J
///   power       F.(velocity of P's body at x_P - velocity of S's body at x_P)       W; all of it but -dV/dt is supply
/// No dissipation.
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
  static const TypeInfo& info();
  static std::unique_ptr<Force> make(const Site&, const Params&);
};

/// Torque M on P's body; with S, -M on S's body.
///
///   torque      M = value + law(t) direction + laws(t), in the axes chosen   N m
///   power       M.(w of P's body - w of S's body)                            W, all of it supply
/// No potential - a constant torque in space has none - and no dissipation.
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
  static const TypeInfo& info();
  static std::unique_ptr<Force> make(const Site&, const Params&);
};

}  // namespace lockstep
