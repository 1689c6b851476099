// Which methods run a mechanism that laws alone move along these laws, without q and v.
#pragma once

#include <lockstep/dynamics.h>
#include <lockstep/integrator.h>

namespace lockstep {

/// Whether a method takes states in these coordinates; null: the slots' own. Where these have none of their own, the rates
/// are those of the slots (Dynamics::rates), which do not fit the state: a method whose coefficients are known takes them, and
/// of the library's own one whose steps are fixed.
inline bool takes(const Integrator& method, const IntegratorInfo& info, const Coordinates* coordinates) {
  if (coordinates == nullptr) return true;
  const bool along_laws = method.scheme() != nullptr || (!info.adaptive && method.origin() == "built in");
  return info.joint && (coordinates->n_v() > 0 || along_laws);
}

/// The same of any method.
inline bool takes(const Integrator& method, const Coordinates* coordinates) {
  return takes(method, method.info(), coordinates);
}

/// Whether a method takes the coordinates that the formulation gives a state.
inline bool takes_formulation(const Integrator& method, Dynamics& dynamics, const State& state) {
  State there = state;
  dynamics.to_formulation(there);
  return takes(method, there.coordinates.get());
}

}  // namespace lockstep
