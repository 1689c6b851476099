// SPDX-License-Identifier: BSD-3-Clause
// Which methods support joint coordinates, and run a mechanism that laws alone move without q and v.
#pragma once

#include <string>

#include <lockstep/author/integrator.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>

namespace lockstep {

/// Whether a method takes states in these coordinates; null: the slots' own. A method with step control of another kind
/// sees no error if nothing is free, and would miss events.
inline bool takes(const Integrator& method, const IntegratorInfo& info, const Coordinates* coordinates) {
  if (coordinates == nullptr) return true;
  return info.joint && (coordinates->n_v() > 0 || !info.adaptive || method.scheme() != nullptr);
}

/// Why a run of a state by this method does not take joint coordinates; "" if it does.
inline std::string why_not_joint(Dynamics& dynamics, const State& state, const Integrator& method) {
  const IntegratorInfo info = method.info();
  if (std::string why = dynamics.why_not_joint(state.modes); !why.empty()) return why;
  if (!info.joint) return "integrator " + info.name + " does not support joint coordinates";
  State there = state;
  dynamics.to_formulation(there);
  return takes(method, info, there.coordinates.get())
             ? ""
             : "integrator " + info.name + " does not support a mechanism that is moved by laws alone";
}

/// Throws ModelError with that reason, unless there is none.
inline void refuse_joint(const std::string& why) {
  if (why.empty()) return;
  throw ModelError("joint coordinates (formulation joint) are not possible: " + why +
                   "; use formulation auto or omega");
}

}  // namespace lockstep
