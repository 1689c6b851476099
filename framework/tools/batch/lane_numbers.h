// Numbers: the arrays of the copies; every number is a pack of eight. Private to the room.
#pragma once

#include "framework/tools/batch/lane_plan.h"

namespace lockstep::lanes {

/// By slot (and the ground behind them): body, and without the ground mass, a_f, a, wrench. By unknown: x ... Cd.
struct Numbers {
  const double* y = nullptr;     ///< state: q, v, s
  const double* mass = nullptr;  ///< (lane_plan.h, mass)
  const double* gravity = nullptr;
  const double* wrench = nullptr;  ///< of the forces: 6 a slot; null: there are none
  const double *frames = nullptr, *law = nullptr;
  double *body = nullptr, *af = nullptr, *a = nullptr;
  double *J = nullptr, *Y = nullptr, *A = nullptr;
  double *x = nullptr, *c = nullptr, *scale = nullptr, *diagonal = nullptr, *E = nullptr, *lambda = nullptr,
         *r = nullptr, *C = nullptr, *Ct = nullptr;
  double eps = 0;  ///< of the proximal term; 0: none
};

}  // namespace lockstep::lanes
