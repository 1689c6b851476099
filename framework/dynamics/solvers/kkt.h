// Kkt: the matrix of one evaluation as blocks, ready for a solver.
//
//   | M   J^T | | a |   | f |      nodes: a slot (width 6; a particle 3; 7 in the paper's form), a link (m rows)
//   | J   -E  | | l | = | c |      generalised constraint force = -J^T lambda (theory, (2.1))
#pragma once

#include <vector>

#include "framework/mechanism/rows/rows.h"
#include "framework/foundation/support/export.h"

namespace lockstep {

/// Rows of one link in the matrix.
struct KktLink {
  int link = -1;  ///< number in the system; -1: unit-length row of a quaternion
  int first_row = 0, m = 0, n_slots = 0;
  std::array<int, kMaxSlots> slot{};
  std::array<RowKind, kMaxRows> kind{};
  std::size_t J = 0;  ///< offset of its first jacobian in Kkt::J: m x width of slot 0, then of slot 1 ...
};

/// Mass and inertia (slot axes) of a slot; a particle does not turn.
struct SlotMass {
  double m = 0;
  Mat3 J = Mat3::Zero();
  bool particle = false;
};

/// Shape of the matrix; changes only when the set of active links does.
struct KktPattern {
  /// For solvers that read the rows where the links wrote them (LinearSolver::reads_rows): six unknowns a slot, and
  /// neither M nor J nor E are filled. Otherwise null.
  const RowTable* rows = nullptr;
  int n_slots() const { return static_cast<int>(width.size()); }
  Plane plane;                    ///< of `rows`
  std::vector<int> width, first;  ///< of each slot: unknowns and the first of them
  std::vector<std::size_t> M;     ///< offset of each slot's width x width block in Kkt::M
  std::vector<KktLink> links;
  int n = 0, m = 0;  ///< unknowns, rows
  std::size_t size_M = 0, size_J = 0;
};

/// Numbers of the matrix. All blocks row-major.
struct LOCKSTEP_API Kkt {
  KktPattern pattern;
  std::vector<double> M, Minv;  ///< mass blocks, symmetric positive definite, and their inverses
  std::vector<double> J;
  VecX E;                        ///< one a row: scale s_j of the proximal term (E itself is eps times it)
  std::vector<SlotMass> masses;  ///< with KktPattern::rows

  /// s_j of every row: mean of the diagonal of J M^-1 J^T over the link's force rows, over its moment rows, of a single
  /// row for a function (framework/docs/solvers.md, section 5). Reactions of redundant rows then depend on no frame.
  void update_scales();
};

}  // namespace lockstep
