// KktAssembler: writes the gathered rows and the masses as the saddle-point matrix of a formulation.
//
// Formulation::omega       6 velocities per body, M = diag(m 1, J) constant, written once (2.9)
// Formulation::quaternion  the paper's 7 coordinates: M = diag(m 1, G^T J G), rows Jh G with Qhat (a consistent pair,
//                          2.13), one unit-length row per body (2.6). G^T J G is singular along q; k q q^T is added to
//                          it and -k |qd|^2 q to the right side, which the unit-length row makes void (2.7).
#pragma once

#include "framework/dynamics/evaluate/stabilization.h"
#include "framework/dynamics/solvers/kkt.h"
#include "framework/mechanism/model/body_mass.h"
#include "framework/mechanism/system/system.h"

namespace lockstep {

class LOCKSTEP_API KktAssembler {
 public:
  KktAssembler(const System& system, Formulation formulation) : system_(system), formulation_(formulation) {}

  /// Shape, when the set of active links changed. `direct`: for a solver that reads the rows themselves; nothing is
  /// copied then, and load and unload are not needed. Throws ModelError where the formulation cannot be had.
  void lay_out(const RowTable& rows, bool direct);
  bool direct() const { return kkt_.pattern.rows != nullptr; }
  /// Numbers: jacobians, and the mass blocks where they move. `motions`: ground, then slots.
  void update(const RowTable& rows, std::span<const Motion> motions);
  /// For a direct solver: where the rows are read from now on.
  void read(const RowTable& rows);
  const Kkt& kkt() const { return kkt_; }
  int n() const { return kkt_.pattern.n; }  ///< unknowns of the formulation
  int m() const { return kkt_.pattern.m; }  ///< its rows, those of unit length included

  /// f (6 per slot: N, world; N m, slot axes) and c (1 per row of the table) as the formulation's own right side.
  /// `moving`: the accelerations of the unit-length rows and of the mass matrix are wanted too (equations of motion, not
  /// a projection).
  void load(const VecX& f6, const VecX& c6, std::span<const Motion> motions, bool moving, VecX& f, VecX& c) const;
  /// The formulation's solution as 6 per slot and one multiplier per row of the table.
  void unload(const VecX& a, const VecX& lambda, std::span<const Motion> motions, int n_rows, VecX& a6,
              VecX& lambda6) const;

 private:
  void lay_out_direct(const RowTable& rows);
  void write_mass(int slot, const Motion& O);

  const System& system_;
  Formulation formulation_;
  Kkt kkt_;
  std::vector<BodyMass> masses_;  // of slots, where the matrix is filled here
  int n_links_ = 0;  // of the table; unit-length rows follow them
};

}  // namespace lockstep
