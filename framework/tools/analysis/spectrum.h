// SPDX-License-Identifier: BSD-3-Clause
// Eigenvalues of l^2 M + l D + K in motions of a mechanism, zeros separated from round-off.
#pragma once

#include <complex>
#include <vector>

#include <lockstep/linearization.h>

namespace lockstep {

/// One eigenvalue: a zero, a real one, or of a pair that with Im l > 0.
struct Eigenvalue {
  std::complex<double> l;
  double bound;        ///< its error by round-off and residual accelerations
  Eigen::VectorXcd x;  ///< its motion, in the unknowns
};

struct Spectrum {
  double zero_bound = 0;        ///< |l| below which eigenvalues are zero, 1/s
  int zeros = 0;                ///< number of eigenvalues that are zero
  std::vector<Eigenvalue> all;  ///< by rising |l|; of zeros one for each motion that nothing holds
};

/// That of the motions N y. Throws SolveError if M is not positive definite or the decomposition does not converge.
Spectrum spectrum_of(const LinearMotion&, const MatX& N);

/// A basis of motions on the constraints in which the `count` modes nearest to zero lie, in the unknown velocities: the
/// spectrum of the mechanism in it (spectrum_of()) is theirs. `redundant`: whether rows depend on one another. Throws
/// SolveError where they do not settle.
MatX lowest_motions(const LinearMotion&, int count, bool redundant);

/// A x = l x of a dense matrix; compiled once, since Eigen's solvers cost seconds in each file that names them.
struct Eigenvectors {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;  ///< a column for each value
};
/// Throws SolveError if the iteration does not converge.
Eigenvectors eigenvectors(const MatX& A);

}  // namespace lockstep
