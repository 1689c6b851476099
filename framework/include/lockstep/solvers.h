// SPDX-License-Identifier: BSD-3-Clause
// The linear solvers.
#pragma once

#include <memory>

#include <lockstep/author/params.h>
#include <lockstep/author/solver.h>

namespace lockstep {

// "block": LDL^T in blocks over the graph of slots and joints, leaves first, with proximal corrections
// (framework/docs/solvers.md, sections 4, 5).
//
//   | M   J^T |      E' = eps E:  lambda = 0;  repeat  (a, lambda) += K^-1 (f - M a - J^T lambda, c - J a)
//   | J   -E' |

/// LDL^T in blocks over the graph of slots and joints. Work grows linearly with the number of bodies on every tree,
/// even if one body has many joints; nothing is allocated after analyse(). The same elimination serves implicit
/// methods, whose mass matrix couples bodies (NewtonMatrix).
///
/// SolveReport::smallest_pivot: of a row, relative to its scale E_j: the part of its square that is independent of the
/// rows before it. Redundant rows leave about eps.
class LOCKSTEP_API BlockSolver final : public LinearSolver {
 public:
  static TypeInfo info();                                    ///< its entry in the registry; it has no keys
  static std::unique_ptr<LinearSolver> make(const Params&);  ///< maker for the registry

  std::string_view name() const override { return "block"; }
  /// compute() throws SolveError for a body without mass or inertia.
  std::unique_ptr<Factorization> analyse(const KktPattern&) const override;
};

// "dense": rank-revealing QR; the reference for small systems.
//
//   M = L L^T,  B = E^-1/2 J L^-T (m x n):   a = M^-1 f + L^-T y,  y = B^+ E^-1/2 (c - J M^-1 f),
//   lambda = E^-1/2 mu,  B^T mu = -y,  |mu| minimal: of all lambda the one with the smallest sum E_j lambda_j^2.
// If the rows contradict one another, a minimises sum (c - J a)_j^2 / E_j, as the proximal iteration does.

/// Rank-revealing QR, the reference for small systems: its work grows with the cube of the number of rows.
/// SolveReport::rank is the rank by which it solved; smallest_pivot: of the rows in the order of the QR, the smallest part
/// of a row's own square (metric of M^-1) that is independent of the rows before it.
class LOCKSTEP_API DenseSolver final : public LinearSolver {
 public:
  static TypeInfo info();                                    ///< its entry in the registry; it has no keys
  static std::unique_ptr<LinearSolver> make(const Params&);  ///< maker for the registry

  std::string_view name() const override { return "dense"; }
  /// compute() throws SolveError for a mass block that is not positive definite, with the number of its slot.
  std::unique_ptr<Factorization> analyse(const KktPattern&) const override;
};

// SchurSolver: S = J M^-1 J^T over the graph of the joints, block by block (framework/docs/solvers.md, sections 2 and
// 5).

/// Schur complement over the graph of the joints: the default. It reads the rows from the memory of the joints, in six
/// velocities per slot, three in a plane. On a tree there is no fill, and time and memory grow linearly with the number
/// of bodies; a slot with many joints becomes a node itself. Nothing is allocated after analyse().
class LOCKSTEP_API SchurSolver final : public LinearSolver {
 public:
  static TypeInfo info();                                    ///< its entry in the registry; it has no keys
  static std::unique_ptr<LinearSolver> make(const Params&);  ///< maker for the registry

  std::string_view name() const override { return "schur"; }
  bool reads_rows() const override { return true; }
  std::unique_ptr<Factorization> analyse(const KktPattern&) const override;
};

// "sparse": Eigen's LDL^T on the scalars of the quasi-definite matrix, with proximal corrections
// (framework/docs/solvers.md, sections 4, 5).
//
//   K = | M   J^T |      E' = eps E:  lambda = 0;  repeat  (a, lambda) += K^-1 (f - M a - J^T lambda, c - J a)
//       | J   -E' |

/// Eigen's sparse LDL^T, the fallback and the cross-check: any topology, redundant rows; the fill of the joints' graph
/// determines its work.
///
/// SolveReport::smallest_pivot: every slot is eliminated before any joint, so the pivot of row j is -D_j, with D the
/// diagonal of the LDL^T of S + E', S = J M^-1 J^T. D_j / (S_jj + E'_j) is in (0, 1]: the part of the row's own square
/// that is independent of the rows before it. Redundant rows leave about eps.
class LOCKSTEP_API SparseSolver final : public LinearSolver {
 public:
  static TypeInfo info();                                    ///< its entry in the registry; it has no keys
  static std::unique_ptr<LinearSolver> make(const Params&);  ///< maker for the registry

  std::string_view name() const override { return "sparse"; }
  /// compute() throws SolveError if a pivot is zero: a body without mass or inertia.
  std::unique_ptr<Factorization> analyse(const KktPattern&) const override;
};

}  // namespace lockstep
