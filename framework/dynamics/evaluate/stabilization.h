// How drift off the constraints is fought.
#pragma once

namespace lockstep {

struct Stabilization {
  enum class Kind { project, baumgarte, none };
  Kind kind = Kind::project;
  double alpha = 5, beta = 5;  ///< Baumgarte's rates, 1/s: Cdd + 2 alpha Cd + beta^2 C = 0 (2.15)
  double tolerance = 1e-10;    ///< of |C| in metres (radians times the scene's length), for projection and assembly
};

/// Which unknowns the equations of motion have: 6 velocities a body, or the paper's 7 coordinates with unit-length
/// rows.
enum class Formulation { omega, quaternion };

}  // namespace lockstep
