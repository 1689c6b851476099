// The linear solvers.
#pragma once

#include <memory>

#include <lockstep/params.h>
#include <lockstep/solver.h>

namespace lockstep {

// "block": LDL^T in blocks over the graph of slots and links, leaves first, with proximal corrections (framework/docs/solvers.md,
// sections 4, 5).
//
//   | M   J^T |      E' = eps E:  lambda = 0;  repeat  (a, lambda) += K^-1 (f - M a - J^T lambda, c - J a)
//   | J   -E' |


class Params;
struct TypeInfo;

/// Linear in the number of bodies on trees of any kind, hubs too; no allocation after analyse. The same factorisation
/// serves implicit methods, whose mass matrix couples bodies (dynamics/evaluate/implicit.h).
///
/// smallest_pivot: of a row, against its scale E_j: the part of its square that is independent of the rows before it.
/// Redundant rows leave about eps.
class LOCKSTEP_API BlockSolver final : public LinearSolver {
 public:
  static TypeInfo info();
  static std::unique_ptr<LinearSolver> make(const Params&);

  std::string_view name() const override { return "block"; }
  /// compute() throws SolveError for a body without mass or inertia.
  std::unique_ptr<Factorization> analyse(const KktPattern&) const override;
  /// Multiplications of one factorisation.
  static long multiplications(const KktPattern&);
};


// "dense": rank-revealing QR; the referee for small systems.
//
//   M = L L^T,  B = E^-1/2 J L^-T (m x n):   a = M^-1 f + L^-T y,  y = B^+ E^-1/2 (c - J M^-1 f),
//   lambda = E^-1/2 mu,  B^T mu = -y,  |mu| minimal: of all lambda the one with the smallest sum E_j lambda_j^2.
// Where the rows contradict one another, a minimises sum (c - J a)_j^2 / E_j, as the proximal iteration does.


class Params;
struct TypeInfo;

/// Work grows with the cube of the rows. SolveReport::rank is the rank of J; smallest_pivot: of the rows in the order
/// of the QR, the smallest part of a row's own square (metric of M^-1) that is independent of the rows before it.
class LOCKSTEP_API DenseSolver final : public LinearSolver {
 public:
  static TypeInfo info();
  static std::unique_ptr<LinearSolver> make(const Params&);

  std::string_view name() const override { return "dense"; }
  /// compute() throws SolveError: a mass block that is not positive definite, by its slot.
  std::unique_ptr<Factorization> analyse(const KktPattern&) const override;
};


// SchurSolver: S = J M^-1 J^T over the graph of the links, block by block (framework/docs/solvers.md, sections 2 and 5).


/// The default. Reads the rows where the links wrote them, in six velocities a slot, three in a plane; a step costs
/// time and memory in proportion to the bodies, trees without fill, slots with many links by a node of their own.
/// Nothing is allocated after analyse().
class LOCKSTEP_API SchurSolver final : public LinearSolver {
 public:
  static TypeInfo info();
  static std::unique_ptr<LinearSolver> make(const Params&);

  std::string_view name() const override { return "schur"; }
  bool reads_rows() const override { return true; }
  std::unique_ptr<Factorization> analyse(const KktPattern&) const override;
};


// "sparse": Eigen's LDL^T on the scalars of the quasi-definite matrix, with proximal corrections (framework/docs/solvers.md,
// sections 4, 5).
//
//   K = | M   J^T |      E' = eps E:  lambda = 0;  repeat  (a, lambda) += K^-1 (f - M a - J^T lambda, c - J a)
//       | J   -E' |


class Params;
struct TypeInfo;

/// The fallback and the cross-check: any topology, redundant rows, work as the fill of the links' graph.
///
/// smallest_pivot: every slot is eliminated before any link, so the pivot of row j is -D_j, D_j that of the Cholesky
/// factor of S + E', S = J M^-1 J^T. D_j / (S_jj + E'_j) lies in (0, 1]: the part of the row's own square that is
/// independent of the rows before it. Redundant rows leave about eps.
class LOCKSTEP_API SparseSolver final : public LinearSolver {
 public:
  static TypeInfo info();
  static std::unique_ptr<LinearSolver> make(const Params&);

  std::string_view name() const override { return "sparse"; }
  /// compute() throws SolveError when the factorisation breaks down.
  std::unique_ptr<Factorization> analyse(const KktPattern&) const override;
};

}  // namespace lockstep
