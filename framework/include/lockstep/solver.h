// The saddle-point matrix and the solvers' interface.
#pragma once

#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include <lockstep/export.h>
#include <lockstep/rows.h>

namespace lockstep {

// Kkt: the matrix of one evaluation as blocks, ready for a solver.
//
//   | M   J^T | | a |   | f |      nodes: a slot (width 6; a particle 3; 7 in the paper's form), a link (m rows)
//   | J   -E  | | l | = | c |      generalised constraint force = -J^T lambda (theory, (2.1))


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


// LinearSolver and Factorization: solve the saddle-point system of one evaluation, whatever the topology and however
// redundant the rows.


/// What a solution met and how it was reached.
struct SolveReport {
  double residual = 0;  ///< largest |J a - c| over the rows, each against its own scale
  int worst_row = -1;   ///< the row of that residual
  int corrections = 0;  ///< proximal corrections made
  int rank = -1;        ///< rank of J where the solver reveals it, else -1
  double smallest_pivot = std::numeric_limits<double>::infinity();  ///< relative; small: redundant or singular
  /// The smallest relative pivot beyond those of rows that are redundant everywhere: falls as the square of the
  /// distance to a singular position. Infinite where the solver does not tell.
  double detector = std::numeric_limits<double>::infinity();
  bool contradictory = false;  ///< the rows cannot all hold: the residual stays at the order of its scale
};

/// The numbers of one factored matrix, and its solutions. Nothing is allocated after LinearSolver::analyse() (Eigen's own
/// sparse factorisation may). Earlier matrices of the same factorization tell redundant rows from a singular position.
class LOCKSTEP_API Factorization {
 public:
  virtual ~Factorization();
  /// Factors this matrix, whose shape is the analysed one. Throws SolveError.
  virtual void compute(const Kkt&) = 0;
  /// M a + J^T lambda = f, J a = c, by the matrix computed last; of all lambda the smallest in the metric of E. Where
  /// the solver reads rows (KktPattern::rows) and they were written since compute(), the matrix is still the old one, and
  /// the residual is left to the caller, who iterates.
  virtual SolveReport solve(const Kkt&, const VecX& f, const VecX& c, VecX& a, VecX& lambda) = 0;
  /// Fills what a report of the last solution costs time to know (residual, pivots, detector) where solve() left it out.
  virtual void complete(SolveReport&) {}
};

/// A method, without numbers: from the shape of a matrix it makes factorizations, as many as the caller wants to hold.
class LOCKSTEP_API LinearSolver {
 public:
  virtual ~LinearSolver();
  virtual std::string_view name() const = 0;
  /// Sizes, ordering, symbolic work; once for every set of active links.
  virtual std::unique_ptr<Factorization> analyse(const KktPattern&) const = 0;
  /// Whether it takes the rows from KktPattern::rows instead of M, J and E.
  virtual bool reads_rows() const { return false; }
};

}  // namespace lockstep
