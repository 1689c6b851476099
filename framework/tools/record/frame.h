// Frame: a body's frame or a marker, and its motion in the world or relative to another one.
#pragma once

#include <lockstep/relative.h>
#include <lockstep/step_loop.h>

namespace lockstep::channels {

/// Stays valid through a new set-up of the system: it is folded into its slot anew after each.
struct Frame {
  const Body* body = nullptr;
  const Marker* marker = nullptr;  ///< null: the body's own frame
  MarkerFrame folded() const;
  /// The same, folded once for each set-up.
  const MarkerFrame& in(const System&) const;

  mutable MarkerFrame last{};  ///< as folded for the set-up of this number
  mutable long revision = -1;
};

/// World axes; alpha is the rate of w.
struct FrameMotion {
  Vec3 x, v, w;
  Quat q;
  Mat3 A;
};
struct FrameAcceleration {
  Vec3 a, alpha;
};

FrameMotion motion_of(const Frame&, const Sample&);
FrameAcceleration acceleration_of(const Frame&, const Sample&);

/// Frame m relative to frame n, in n's axes: its origin and its angular velocity with their rates, and its quaternion.
struct Relative {
  Vec3 x, v, w;
  Quat q;
  Vec3 a = Vec3::Zero(), alpha = Vec3::Zero();  ///< the second rate of x, the rate of w
};
Relative relative(const Frame& m, const Frame& n, const Sample&);
/// With a and alpha, which need the accelerations.
Relative relative_with_second(const Frame& m, const Frame& n, const Sample&);

}  // namespace lockstep::channels
