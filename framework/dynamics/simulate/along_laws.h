// Which methods run a mechanism that laws alone move along these laws, without q and v.
#pragma once

#include <lockstep/dynamics.h>
#include <lockstep/integrator.h>

namespace lockstep {

/// Whether a method takes states in these coordinates; null: the slots' own. One that chooses its steps by a way of its own
/// sees no error where nothing is free, and would pass events by.
inline bool takes(const Integrator& method, const IntegratorInfo& info, const Coordinates* coordinates) {
  if (coordinates == nullptr) return true;
  return info.joint && (coordinates->n_v() > 0 || !info.adaptive || method.scheme() != nullptr);
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
