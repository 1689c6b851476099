// SPDX-License-Identifier: BSD-3-Clause
// Frame: a body's frame, a marker or the world, at the states of a run.
#pragma once

#include <lockstep/author/jet.h>
#include <lockstep/author/relative.h>
#include <lockstep/step_loop.h>
#include "framework/mechanism/lock/coordinate.h"

namespace lockstep::channels {

/// Stays valid through a new set-up of the system: it is folded into its slot again after each.
struct Frame : BodyOrMarker {
  /// On its slot. Valid as long as the inputs of the sample are.
  MarkerOn<double> at(const Sample&) const;
  /// Its motion with the rates of all numbers, which needs the accelerations; second rates are not among them.
  MotionT<Time> moving(const Sample&) const;

  mutable MarkerFrame last{};  ///< as folded for the set-up of this number
  mutable long revision = -1;
};

}  // namespace lockstep::channels
