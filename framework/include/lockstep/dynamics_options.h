// SPDX-License-Identifier: BSD-3-Clause
// Stabilisation and formulation: the choices that the equations of motion leave open.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <lockstep/detail/export.h>

namespace lockstep {

/// How drift off the constraints is removed.
struct Stabilization {
  /// The method.
  enum class Kind {
    project,    ///< the end of every step is projected onto the constraints
    baumgarte,  ///< Baumgarte stabilisation: terms are added to the acceleration constraints
    none        ///< the drift stays
  };
  Kind kind = Kind::project;  ///< the method
  double alpha = 5,           ///< Baumgarte rates, 1/s: Cdd + 2 alpha Cd + beta^2 C = 0 (2.15)
      beta = 5;               ///< the other of the two, 1/s
  double tolerance = 1e-10;   ///< |C| that a projection may leave, m (Evaluation::norm)
};

/// Unknowns of the equations of motion.
enum class Formulation {
  omega,       ///< six velocities per body
  quaternion,  ///< the paper's seven coordinates per body, with a unit-length row each
  joint,       ///< joint coordinates, with the rows of loop-closure constraints (Dynamics::why_not_joint)
  automatic    ///< joint if it costs fewer operations and the integrator supports it, else omega
};
/// "omega", "quaternion", "joint", "auto".
LOCKSTEP_API std::string to_string(Formulation);
/// The formulation of such a word. Throws ModelError for any other.
LOCKSTEP_API Formulation formulation_from(std::string_view word);
/// These words, in the order of the enumeration.
LOCKSTEP_API std::vector<std::string> formulation_names();

/// Formulation and stabilisation.
struct DynamicsOptions {
  Formulation formulation = Formulation::automatic;  ///< unknowns of the equations of motion
  Stabilization stabilization{};                     ///< how drift off the constraints is removed
};

}  // namespace lockstep
