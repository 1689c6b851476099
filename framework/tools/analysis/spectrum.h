// Eigenvalues of l^2 M + l D + K for dense matrices, zeros told from round-off.
#pragma once

#include <complex>
#include <vector>

#include <lockstep/linearization.h>

namespace lockstep {

/// A quadratic eigenproblem in minimal coordinates.
struct QuadraticProblem {
  MatX M, D, K;
  MatX size_D, size_K;  ///< D and K with all terms that were added taken by their size: what round-off is measured by
  double unrest = 0;    ///< what the state's unrest adds to w^2 at most, 1/s^2
};

/// That of the motions N y: of the minimal coordinates, or of those in which some modes lie.
QuadraticProblem problem_in(const LinearMotion&, const MatX& N);

/// Its solution. Vectors are columns, in the problem's coordinates.
struct Spectrum {
  double zero_bound = 0;                     ///< |l| below which eigenvalues are zero, 1/s
  int zeros = 0;                             ///< number of eigenvalues that are zero
  MatX rigid;                                ///< null space of K: coordinates x rigid modes
  std::vector<std::complex<double>> values;  ///< the others: real ones, and of pairs that with Im l > 0; by rising |l|
  std::vector<double> bounds;                ///< of each: what round-off and unrest may have changed
  Eigen::MatrixXcd vectors;                  ///< of each
};

/// Throws SolveError where M is not positive definite or the decomposition does not converge.
Spectrum spectrum_of(const QuadraticProblem&);

}  // namespace lockstep
