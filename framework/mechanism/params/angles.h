// Orientation by named angle sequences, both ways.
#pragma once

#include <string>
#include <vector>

#include "framework/foundation/math/quaternion.h"
#include "framework/foundation/support/export.h"

namespace lockstep {

/// Three turns about the frame's own (moving) axes, one after another: "xyz" (Cardan), "zxz" (Euler), "zxy" (HPB:
/// heading about z, pitch about x, bank about y), or any three letters of x y z without two equal neighbours. Throws
/// ModelError for anything else.
LOCKSTEP_API Quat from_angles(const std::string& sequence, const Vec3& angles);

struct Angles {
  Vec3 value = Vec3::Zero();  ///< rad
  bool gimbal =
      false;  ///< the middle turn makes the outer axes parallel (within 1e-7 rad): the third angle is set to 0
};
LOCKSTEP_API Angles to_angles(const std::string& sequence, const Quat& q);

/// "xyz" for "cardan", "zxz" for "euler", "zxy" for "hpb"; a sequence of letters stands for itself.
LOCKSTEP_API std::string angle_sequence(const std::string& name);

}  // namespace lockstep
