// SPDX-License-Identifier: BSD-3-Clause
// Kinematics and inverse dynamics: a fully driven mechanism over time, without integration.
#pragma once

#include <string>
#include <vector>

#include <lockstep/state.h>

namespace lockstep {

class Dynamics;
class MotionLaw;
struct Solution;

/// What keeps the motion of a mechanism from following from its laws alone.
struct DriveReport {
  int freedoms = 0;                   ///< motions that neither links nor drives determine
  std::vector<std::string> free;      ///< these motions in words: "'crank' turns about z"
  std::vector<std::string> to_drive;  ///< as many free coordinates of links that would determine them: "A.rz"
  /// Drives of which one determines what others do already, set by set: "A.rz", "D.rz".
  std::vector<std::vector<std::string>> too_many;

  bool fully_driven() const { return freedoms == 0 && too_many.empty(); }  ///< neither too few drives nor too many
  LOCKSTEP_API std::string text()
      const;  ///< what to drive and what to release, in sentences; "" where it is fully driven
};

/// Counts at this state, which must fit its rows (assemble()). It allocates. Throws NonFiniteError.
LOCKSTEP_API DriveReport driven_by(Dynamics&, const State&);

/// A fully driven mechanism at one instant after another. Positions: Newton's method on the rows from the pose before
/// and its derivatives; velocities: Jh v = -Ct; accelerations, and with the masses the forces of drives and all
/// reactions: one solution of the equations of motion. Nothing is integrated but drives by speed (Gauss-Legendre), and
/// no error accumulates. Nothing is allocated after the first two poses, with the default solver and without drives by
/// speed.
class LOCKSTEP_API DrivenMotion {
 public:
  /// `start`: assembled. Both must outlive this, the dynamics unused by others between a call of to() and the use of what
  /// it returns. Throws ModelError with DriveReport::text() where the motion is not determined, or with the names of
  /// integrated states that are no drives by speed.
  DrivenMotion(Dynamics&, State start);

  /// Goes to time t, s, forwards or back, in as many steps as the way there needs to stay on its branch. Valid until the
  /// next call. Throws AssemblyError, with the time and the worst row, where no position fits there, where the mechanism
  /// cannot move as its laws ask (a dead centre), or where a law jumps in position; the motion then stays at the last
  /// pose that it reached.
  const Solution& to(double t);
  const State& state() const { return state_; }  ///< the present pose and velocity
  long steps() const { return steps_; }          ///< made so far, those in between included

 private:
  bool step(double t);
  bool settle_angles();
  void move_speed_drives(double t0, double t1);
  void check_states() const;
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
