// Applied: a vector of force or torque in chosen axes, constant and by laws; what applied_force and applied_torque
// share.
#pragma once

#include <array>
#include <string>

#include "framework/mechanism/forces/marker_force.h"
#include "framework/mechanism/forces/variation.h"

namespace lockstep {

/// In which axes an applied vector stands still: the world's, those of P's body, or those of marker P.
enum class AppliedAxes { world, body, marker };

/// value + law(t) direction + (laws_x, laws_y, laws_z)(t); what is left out is zero.
struct AppliedVector {
  Vec3 value = Vec3::Zero();                ///< N or N m
  LawPtr<MotionLaw> law{};                  ///< N or N m, along `direction`
  Vec3 direction = Vec3::Zero();            ///< any length but zero; needed with `law`
  std::array<LawPtr<MotionLaw>, 3> laws{};  ///< N or N m, the three components
  AppliedAxes axes = AppliedAxes::world;
};

class LOCKSTEP_API Applied : public MarkerForce {
 public:
  /// `value_key` names AppliedVector::value in messages. Throws ParameterError (a ModelError).
  Applied(std::string name, Marker& p, Marker* s, AppliedVector vector, const char* value_key);
  ~Applied() override;

  void setup() override;
  static Keys keys(const char* value_key, Unit unit);
  /// The vector that `keys` describe. Throws SceneError.
  static AppliedVector read(const Params&, const char* value_key);

 protected:
  Vec3 in_world_axes(const Inputs&) const;  ///< the vector now
  VaryingVector varying(const Inputs&, const Variation&) const;
  /// The part that is constant in the world; zero in other axes.
  Vec3 constant() const { return vector_.axes == AppliedAxes::world ? vector_.value : Vec3(Vec3::Zero()); }

 private:
  Vec3 in_its_axes(const Inputs&) const;
  AppliedVector vector_;
  Mat3 body_axes_ = Mat3::Identity();  // body axes -> slot axes; made by setup()
};

}  // namespace lockstep
