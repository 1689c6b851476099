#include "framework/foundation/math/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>

#include <lockstep/error.h>

namespace lockstep {

namespace {
using Orthogonal = Eigen::CompleteOrthogonalDecomposition<MatX>;
}

SingularValues singular_values(const MatX& A) {
  const Eigen::JacobiSVD<MatX, Eigen::NoQRPreconditioner> svd(A, Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

VecX least_norm(const MatX& A, const VecX& b, double limit) {
  Orthogonal factor;
  if (limit > 0) factor.setThreshold(limit);
  factor.compute(A);
  return factor.solve(b);
}

MatX null_space(const MatX& A) {
  const Orthogonal factor(A);
  return factor.colsPermutation() * MatX(factor.matrixZ().adjoint().rightCols(A.cols() - factor.rank()));
}

Eigenvectors eigenvectors(const MatX& A) {
  const Eigen::EigenSolver<MatX> solver(A);
  if (solver.info() != Eigen::Success) throw SolveError("the eigenvalues of a matrix did not converge");
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace lockstep
