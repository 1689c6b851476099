// SPDX-License-Identifier: BSD-3-Clause
// Markers on their slots.
#pragma once

#include <vector>

#include <lockstep/author/law.h>
#include <lockstep/body.h>
#include <lockstep/math.h>
#include <lockstep/state.h>

namespace lockstep {

/// Motion of a marker on its slot at one instant.
template <class T>
struct MarkerMotionT {
  Vec3T<T> u = Vec3T<T>::Zero(),      ///< origin, slot axes, m
      ud = Vec3T<T>::Zero(),          ///< its velocity on the slot, slot axes, m/s
      udd = Vec3T<T>::Zero();         ///< its acceleration, m/s^2
  Mat3T<T> A = Mat3T<T>::Identity();  ///< marker axes -> slot axes
  QuatT<T> q;                         ///< quaternion of A
  Vec3T<T> w = Vec3T<T>::Zero(),  ///< angular velocity relative to the slot, marker axes, rad/s: pi of P, sigma of S
      a = Vec3T<T>::Zero();       ///< its derivative, rad/s^2: pid of P, sigmad of S
};
/// On doubles.
using MarkerMotion = MarkerMotionT<double>;

/// The same of a marker at rest on its slot, which has no rates.
template <class T>
struct MarkerAtRestT {
  Vec3T<T> u = Vec3T<T>::Zero();      ///< origin, slot axes, m
  Mat3T<T> A = Mat3T<T>::Identity();  ///< marker axes -> slot axes
  QuatT<T> q;                         ///< quaternion of A
};
/// On doubles.
using MarkerAtRest = MarkerAtRestT<double>;

/// Imposed translation p(t) of P, S axes (q_Delta of the paper).
template <class T>
struct ImposedTranslationT {
  Vec3T<T> p = Vec3T<T>::Zero(),  ///< m
      pd = Vec3T<T>::Zero(),      ///< m/s
      pdd = Vec3T<T>::Zero();     ///< m/s^2
};
/// On doubles.
using ImposedTranslation = ImposedTranslationT<double>;
/// Imposed rotation q_D(t) of the frame D relative to S (q_sDelta of the paper).
template <class T>
struct ImposedRotationT {
  QuatT<T> q;                         ///< D axes -> S axes
  Mat3T<T> A = Mat3T<T>::Identity();  ///< A(q)
  Vec3T<T> w = Vec3T<T>::Zero(),      ///< angular velocity delta of D relative to S, D axes, rad/s
      a = Vec3T<T>::Zero();           ///< its derivative deltad, rad/s^2
};
/// On doubles.
using ImposedRotation = ImposedRotationT<double>;

// MarkerFrame: a marker as a frame of its slot. Kernels see slots only, and need no special case for bodies that share
// one or that are fixed.

/// A marker as a frame of the slot of its body.
struct MarkerFrame {
  int slot = kGround;          ///< slot of its body; kGround if that is fixed
  Vec3 u0 = Vec3::Zero();      ///< origin without laws, slot axes, m
  Quat q0;                     ///< marker axes without laws -> slot axes
  Mat3 A0 = Mat3::Identity();  ///< A(q0)
  LawPtr<TranslationLaw>
      translation_law;               ///< moves the origin along the axes of A0; null: none. Shared with the marker
  LawPtr<RotationLaw> rotation_law;  ///< rotates the axes; null: none. Shared with the marker
  MarkerMotion home;                 ///< at(t) of a marker without laws

  MarkerFrame() = default;
  /// Of a marker on a body that has its slot already (System::setup).
  LOCKSTEP_API explicit MarkerFrame(const Marker& m);

  /// Whether its laws declare that they keep a mechanism in this plane.
  LOCKSTEP_API bool stays_in_plane(Plane plane) const;
  /// Whether it is at rest with the axes of the slot and q0 = +1: q0 = -1 is the same rotation, but changes the sign of
  /// e.
  LOCKSTEP_API bool parallel() const;

  /// Origin, axes and their rates at time t: u = u0 + A0 x(t), q = q0 q(t). Defined in relative.h, for inner loops.
  inline MarkerMotion at(double t) const;
  /// Appends the times in (t0, t1) when one of its laws jumps.
  LOCKSTEP_API void breakpoints(double t0, double t1, std::vector<double>& out) const;
};

/// Motion of a marker in the world.
struct MarkerInWorld {
  Vec3 x,  ///< origin, m
      v,   ///< its velocity, world axes, m/s
      w;   ///< angular velocity, world axes, rad/s
  Mat3 A;  ///< marker axes -> world
};
/// Motion of a marker in the world at these inputs.
LOCKSTEP_API MarkerInWorld in_world(const MarkerFrame& f, const Inputs& in);

/// Which of the relative coordinates are wanted; the others cost nothing.
enum class Reads {
  translation = 1,  ///< x y z
  rotation = 2,     ///< e0 e1 e2 e3
  both = 3          ///< all seven
};

/// Whether `which` includes `half`, translation or rotation.
constexpr bool reads(Reads which, Reads half) { return (unsigned(which) & unsigned(half)) != 0; }

}  // namespace lockstep
