// SPDX-License-Identifier: BSD-3-Clause
// The saddle-point matrix and the solvers' interface.
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include <lockstep/author/memory.h>
#include <lockstep/detail/rows.h>

namespace lockstep {

// Kkt: the saddle-point matrix of one evaluation, as blocks for a solver.
//
//   | M   J^T | | a |   | f |      nodes: slots and joints (m rows)
//   | J   -E  | | l | = | c |      generalised constraint force = -J^T lambda (theory, (2.1))
//
// Width of a slot: 6, of a particle 3; in a plane 3 and 2; 7 in the quaternion formulation.

/// Rows of one joint in the matrix.
struct KktLink {
  int link = -1;                         ///< number in the system; -1: unit-length row of a quaternion
  int first_row = 0,                     ///< the first of its rows
      m = 0,                             ///< number of its rows
      n_slots = 0;                       ///< number of moving slots that it touches
  std::array<int, kMaxSlots> slot{};     ///< these slots: the first n_slots entries
  std::array<RowKind, kMaxRows> kind{};  ///< what each row measures: the first m entries
  std::size_t J = 0;  ///< offset of its first Jacobian in Kkt::J: m x width of slot 0, then of slot 1 ...
};

/// Mass and inertia of a slot.
struct SlotMass {
  double m = 0;           ///< mass, kg
  Mat3 J = Mat3::Zero();  ///< inertia about the centre of mass, slot axes, kg m^2
  bool particle = false;  ///< it does not rotate
};

/// Shape of the matrix. It changes only with the description of the system and with the set of active joints.
struct KktPattern {
  /// For solvers that read the rows from the memory of the joints (LinearSolver::reads_rows); every slot then has six
  /// unknowns, and `first`, `M`, `links` and the blocks of Kkt are empty. Otherwise null.
  const RowTable* rows = nullptr;
  int n_slots() const { return static_cast<int>(width.size()); }  ///< moving slots
  Plane plane;                                                    ///< of `rows`
  std::vector<int> width,                                         ///< of each slot: number of its unknowns
      first;                                                      ///< of each slot: the first of its unknowns
  std::vector<std::size_t> M;  ///< of each slot: offset of its width x width block in Kkt::M
  std::vector<KktLink> links;  ///< the active joints, then the unit-length rows of quaternions
  int n = 0,                   ///< number of unknowns
      m = 0;                   ///< number of rows
  std::size_t size_M = 0,      ///< size of Kkt::M
      size_J = 0;              ///< size of Kkt::J
};

/// Numbers of the matrix. All blocks are row-major.
struct LOCKSTEP_API Kkt {
  static constexpr int kUnknown = -1;  ///< see redundant
  KktPattern pattern;                  ///< where each block is
  /// How many rows depend on others in all assembled poses of the present branch except singular ones
  /// (Dynamics::redundancy). kUnknown: as many as have small pivots.
  int redundant = kUnknown;
  bool nearly = false;           ///< some of these rows depend on others nearly, and may be held
  std::vector<double> M,         ///< mass blocks, symmetric positive definite
      Minv;                      ///< their inverses
  std::vector<double> J;         ///< Jacobians, joint after joint
  VecX E;                        ///< one per row: scale s_j of the proximal term (E itself is eps times it)
  std::vector<SlotMass> masses;  ///< of each slot; only with KktPattern::rows

  /// Sets s_j of every row: mean of the diagonal of J M^-1 J^T over the joint's force rows, over its moment rows, of a
  /// single row for a function (framework/docs/solvers.md, section 5). Reactions of redundant rows then depend on no
  /// frame.
  void update_scales();
};

// LinearSolver and Factorization: solve the saddle-point system of one evaluation, for any topology and redundancy.

/// How a solution was reached and how good it is.
struct SolveReport {
  double residual = 0;  ///< largest |J a - c| over the rows, each relative to its own scale
  int worst_row = -1;   ///< the row of that residual; -1: none was measured
  int corrections = 0;  ///< proximal corrections made
  int rank = -1;        ///< rank of J if the solver reveals it, else -1
  double smallest_pivot = std::numeric_limits<double>::infinity();  ///< relative; small: redundant or singular
  /// The smallest relative pivot except those of redundant rows (Kkt::redundant), or an eigenvalue in their place:
  /// decreases as the square of the distance to a singular configuration. Infinite if all rows are redundant, NaN if the
  /// solver does not report it.
  double detector = NAN;
  bool contradictory = false;  ///< the rows contradict one another: the residual stays at the order of its scale
};

/// A factored matrix, and solutions by it. Nothing is allocated after LinearSolver::analyse() (except by Eigen's own
/// sparse factorisation). Nothing is kept of matrices that were factored before.
class LOCKSTEP_API Factorization {
 public:
  virtual ~Factorization();
  /// Factors this matrix, whose pattern must be the one analysed. Throws SolveError if it has no factors.
  virtual void compute(const Kkt&) = 0;
  /// Solves M a + J^T lambda = f, J a = c by the matrix computed last. f and a: one per unknown; c and lambda: one per
  /// row; of all lambda it finds the smallest in the metric of E. If the solver reads rows (KktPattern::rows) that were
  /// written again after compute(), the matrix is still the old one and no residual is measured: the caller iterates.
  virtual SolveReport solve(const Kkt&, const VecX& f, const VecX& c, VecX& a, VecX& lambda) = 0;
  /// Completes the report of the last solution by what costs time: residual, pivots, detector.
  virtual void complete(SolveReport&) {}
};

/// A method, without numbers: makes any number of factorizations of matrices of one shape.
class LOCKSTEP_API LinearSolver {
 public:
  virtual ~LinearSolver();
  /// Its name in the registry and in messages: "schur".
  virtual std::string_view name() const = 0;
  /// Sizes, ordering, symbolic work: once per set of active joints.
  virtual std::unique_ptr<Factorization> analyse(const KktPattern&) const = 0;
  /// Whether it reads the rows from KktPattern::rows instead of M, J and E.
  virtual bool reads_rows() const { return false; }
};

}  // namespace lockstep
