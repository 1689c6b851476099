// Numbers: the arrays of a batch, in packs of eight. Private to the room.
#pragma once

#include "framework/dynamics/solvers/elimination.h"
#include "framework/tools/batch/lane_plan.h"

namespace lockstep::lanes {

/// Those of the elimination (Numbers::rows being J). Per slot, then for the ground: body; per slot: a_f, wrench. Per row:
/// C, Ct.
struct Numbers : schur::Numbers {
  const double* y = nullptr;  ///< state: q, v, s
  const double* gravity = nullptr;
  const double* wrench = nullptr;  ///< of the forces: 6 per slot; null: there are none
  const double *frames = nullptr, *law = nullptr;
  double *body = nullptr, *af = nullptr;
  double *J = nullptr, *C = nullptr, *Ct = nullptr;
};

}  // namespace lockstep::lanes
