// One coordinate of a link, its value and how it changes. Internal to assembly.
#pragma once

#include <string>

#include <lockstep/dynamics.h>
#include <lockstep/kernel.h>

namespace lockstep {

/// Of P relative to S, along or about an axis of S.
struct CoordinateRow {
  double value = 0;  ///< m; or rad, in (-pi, pi]: exact where P turns about that axis alone
  double rate = 0;   ///< m/s or rad/s
  VecX row;          ///< derivative of the rate by the velocities, 6 per slot
};
CoordinateRow coordinate_row(Dynamics&, const State&, const std::string& link, Axis axis);
/// Its value alone.
double coordinate_value(Dynamics&, const State&, const Lock& link, Axis axis);

}  // namespace lockstep
