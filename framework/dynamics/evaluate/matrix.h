// Matrix: the gathered rows as the saddle-point matrix of the chosen formulation.
//
// Formulation::omega       6 velocities a body, M = diag(m 1, J) constant, written once (2.9)
// Formulation::quaternion  the paper's 7 coordinates: M = diag(m 1, G^T J G), rows Jh G with Qhat (a consistent
// pair, 2.13),
//                          one unit-length row a body (2.6). G^T J G is singular along q; k q q^T is added to it and
//                          -k |qd|^2 q to the right side, which the unit-length row makes void (2.7).
#pragma once

#include "framework/dynamics/evaluate/stabilization.h"
#include "framework/dynamics/solvers/kkt.h"
#include "framework/mechanism/system/system.h"

namespace lockstep {

class LOCKSTEP_API Matrix {
 public:
  Matrix(const System& system, Formulation formulation) : system_(system), formulation_(formulation) {}

  /// Shape, when the set of active links changed. `direct`: for a solver that reads the rows themselves; nothing is
  /// copied then, and load and unload are not needed.
  void lay_out(const RowTable& rows, bool direct);
  bool direct() const { return kkt_.pattern.rows != nullptr; }
  /// Numbers: jacobians, and the mass blocks where they move.
  void update(const RowTable& rows, std::span<const Motion> motions);
  const Kkt& kkt() const { return kkt_; }
  int n() const { return kkt_.pattern.n; }
  int m() const { return kkt_.pattern.m; }

  /// f (6 a slot), c (one a row) into the formulation's own right side. `moving`: the accelerations of the unit-length
  /// rows and of the mass matrix are wanted too (equations of motion, not a projection).
  void load(const VecX& f6, const VecX& c6, std::span<const Motion> motions, bool moving, VecX& f, VecX& c) const;
  /// The formulation's solution back into 6 a slot, one multiplier a row of the table.
  void unload(const VecX& a, const VecX& lambda, std::span<const Motion> motions, int n_rows, VecX& a6,
              VecX& lambda6) const;

 private:
  void lay_out_direct(const RowTable& rows);
  void write_mass(int slot, const Motion& O);
  std::array<int, 6> velocities() const;

  const System& system_;
  Formulation formulation_;
  Kkt kkt_;
  int n_links_ = 0;  // of the table; unit-length rows stand behind them
};

}  // namespace lockstep
