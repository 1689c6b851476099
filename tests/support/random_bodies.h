// SPDX-License-Identifier: BSD-3-Clause
// Bodies at random, laws given by their values at t = 0, and accelerations in one form.
#pragma once

#include <vector>

#include <lockstep/author/law.h>
#include <lockstep/author/passes.h>
#include <lockstep/dynamics.h>
#include "tests/support/configuration.h"

namespace lockstep::testing {

using oracle::Draw;

inline Pose random_pose(Draw& draw) { return {draw.vector(1.0), Quat::from(draw.quaternion())}; }

inline Mat3 random_inertia(Draw& draw) {  // of three rods along random directions: every triangle rule holds
  Mat3 J = 0.05 * Mat3::Identity();
  for (int k = 0; k < 3; ++k) {
    const Vec3 d = draw.vector(1.0);
    J += d.squaredNorm() * Mat3::Identity() - d * d.transpose();
  }
  return J;
}

class Quadratic final : public MotionLaw {
 public:
  explicit Quadratic(LawValue at0) : at0_(at0) {}
  LawValue at(double t) const override {
    return {at0_.y + t * (at0_.yd + 0.5 * t * at0_.ydd), at0_.yd + t * at0_.ydd, at0_.ydd};
  }

 private:
  LawValue at0_;
};

/// Accelerations of the slots, world axes, that rates in other coordinates than the slots' own mean: d/dt of velocities
/// along them.
inline VecX accelerations(Dynamics& dynamics, const State& state, const StateRate& rate) {
  std::vector<Motion> motions;
  passes::motions(dynamics.system(), state, motions);
  VecX dx, dv;
  state.coordinates->variations(state, motions, rate, dx, dv);
  return dv;
}

/// Those that omega solves for at a state in any coordinates.
inline VecX accelerations(Dynamics& dynamics, const State& state) {
  const Solution& s = dynamics.evaluate(state);
  VecX a = s.a;
  for (int k = 0; k < dynamics.system().n_slots(); ++k)
    a.segment<3>(6 * k + 3) = s.in.slot(k).A * a.segment<3>(6 * k + 3);
  return a;
}

inline double largest(const VecX& x) { return x.size() > 0 ? x.lpNorm<Eigen::Infinity>() : 0.0; }

}  // namespace lockstep::testing
