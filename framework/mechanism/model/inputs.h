// Inputs: what an evaluation sees of the mechanism. No State and no System: jets and differences can drive a link too.
#pragma once

#include <span>

#include "framework/foundation/math/pose.h"
#include "framework/mechanism/model/body.h"

namespace lockstep {

/// Motion of a slot: x, v in the world; A slot -> world; e its quaternion; w in slot axes.
template <class T>
struct MotionT {
  Vec3T<T> x = Vec3T<T>::Zero();
  Mat3T<T> A = Mat3T<T>::Identity();
  QuatT<T> e;
  Vec3T<T> v = Vec3T<T>::Zero();
  Vec3T<T> w = Vec3T<T>::Zero();
};
using Motion = MotionT<double>;

template <class T>
struct InputsT {
  T t{0};
  std::span<const MotionT<T>> motions;  ///< the ground first, then the slots
  std::span<const T> s;
  std::span<const double> z;

  const MotionT<T>& slot(int k) const { return motions[static_cast<std::size_t>(k + 1)]; }  // kGround = -1 is the first
};
using Inputs = InputsT<double>;

}  // namespace lockstep
