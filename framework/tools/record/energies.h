// SPDX-License-Identifier: BSD-3-Clause
// Energies of a mechanism: of its motion, and works that are integrated with it.
#pragma once

#include <lockstep/step_loop.h>
#include "framework/tools/record/quadrature.h"

namespace lockstep {

/// Energies at one instant, J.
struct Energies {
  double kinetic, potential, drives, supplied, dissipated;
  /// What a motion without error keeps.
  double balance() const { return kinetic + potential - drives - supplied + dissipated; }
};

/// Integrals along the motion: the work of laws, of laws and motors of forces, and the loss of dampers and friction.
enum class Work { drives, supplied, dissipated };
const Quadrature& work_of(System&, Work);

/// Energies at states of a run. What is made for a system integrates works with its motion; links and forces that are
/// added later count too.
class EnergyTerms {
 public:
  /// `all`: also the works of laws, forces and dampers that the system has none of at present.
  EnergyTerms(System&, bool all);
  Energies at(const Sample&) const;

  static double kinetic(const Sample&);
  LOCKSTEP_API static double potential(const Sample&);
  /// Energy lost in the impacts of all unilateral links up to this state, J.
  static double lost_in_impacts(const Sample&);

 private:
  const Quadrature *drives_ = nullptr, *supplied_ = nullptr, *dissipated_ = nullptr;  // null: nothing does such work
  bool impacts_;
};

}  // namespace lockstep
