// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/simulate/damping.h"

#include <algorithm>

namespace lockstep {

namespace {

bool may_damp(const Force& force, const Inputs& in) try {
  return force.dissipation(in) != 0 || force.supply(in) != 0 || force.potential(in) == 0;
} catch (...) {
  return true;
}

}  // namespace

bool may_damp(Dynamics& dynamics, const State& state) {
  if (dynamics.options().stabilization.kind == Stabilization::Kind::baumgarte) return true;
  const Inputs& in = dynamics.inputs(state);
  return std::ranges::any_of(dynamics.system().forces(), [&](const auto& force) { return may_damp(*force, in); });
}

}  // namespace lockstep
