// SPDX-License-Identifier: BSD-3-Clause
// Kinematics and inverse dynamics: a fully driven mechanism over time, without integration.
#pragma once

#include <string>
#include <vector>

#include <lockstep/state.h>

namespace lockstep {

class Dynamics;
struct Solution;

/// Whether the drives prescribe the motion of a mechanism, and what is missing.
struct DriveReport {
  int freedoms = 0;                   ///< degrees of freedom that are not driven
  std::vector<std::string> free;      ///< these motions in words: "'crank' rotates about z"
  std::vector<std::string> to_drive;  ///< as many joint coordinates that would determine them: "A.rz"
  /// Groups of drives that prescribe dependent coordinates: "A.rz", "D.rz".
  std::vector<std::vector<std::string>> too_many;

  bool fully_driven() const { return freedoms == 0 && too_many.empty(); }  ///< neither too few drives nor too many
  LOCKSTEP_API std::string text()
      const;  ///< coordinates to drive and drives to remove, in sentences; "" if it is fully driven
};

/// Counts at this state, which must satisfy the constraints (assemble()). It allocates. Throws NonFiniteError.
LOCKSTEP_API DriveReport driven_by(Dynamics&, const State&);

/// A fully driven mechanism over time. Positions: Newton's method on the constraints, from the previous pose and its
/// derivatives. Velocities: Jh v = -Ct. Accelerations, forces of drives and reactions: one solution of the equations of
/// motion. Only drives by speed are integrated (Gauss-Legendre), so no error accumulates. Nothing is allocated after
/// the first two poses, with the default solver and without drives by speed.
class LOCKSTEP_API DrivenMotion {
 public:
  /// `start`: assembled. Both must outlive this. Do not use the dynamics between a call of to() and the use of its
  /// result. Throws ModelError with DriveReport::text() if the motion is not fully prescribed, or with the names of
  /// integrated states that are no drives by speed.
  DrivenMotion(Dynamics&, State start);

  /// Goes to time t, s, forwards or back, in as many steps as needed to stay on its branch. Valid until the next call.
  /// Throws AssemblyError, with the time and the worst constraint, if no position satisfies the constraints, if the
  /// mechanism cannot follow its drives (a dead centre), or if a law jumps in position. The motion then stays at the
  /// last pose that it reached.
  const Solution& to(double t);
  const State& state() const { return state_; }  ///< the present pose and velocity
  long steps() const { return steps_; }          ///< so far, intermediate ones included

 private:
  bool step(double t);
  bool settle_angles();
  void move_speed_drives(double t0, double t1);
  void check_states() const;
  void refuse_jumps(double t0, double t1);
  [[noreturn]] void refuse(double t) const;

  struct SpeedDrive {
    const MotionLaw* law;
    int state;
  };
  Dynamics& dynamics_;
  State state_, trial_, guess_;
  std::vector<SpeedDrive> speed_drives_;
  VecX a_, jerk_, way_;
  long steps_ = 0;
  std::string why_;
  const Solution* solution_ = nullptr;
};

}  // namespace lockstep
