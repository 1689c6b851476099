// Eigenvalues of l^2 M + l D + K for dense matrices, zeros told from round-off.
#pragma once

#include <complex>
#include <vector>

#include <lockstep/math.h>

namespace lockstep {

/// A quadratic eigenproblem in minimal coordinates.
struct QuadraticProblem {
  MatX M, D, K;
  MatX size_D, size_K;  ///< D and K with all terms that were added taken by their size: what round-off is measured by
  double unrest = 0;    ///< what the state's unrest adds to w^2 at most, 1/s^2
};

/// Its solution. Vectors are columns, in the problem's coordinates.
struct Spectrum {
  double zero_bound = 0;                     ///< |l| below which eigenvalues are zero, 1/s
  int zeros = 0;                             ///< number of eigenvalues that are zero
  MatX rigid;                                ///< null space of K: coordinates x rigid modes
  std::vector<std::complex<double>> values;  ///< the others: real ones, and of pairs that with Im l > 0; by rising |l|
  std::vector<double> bounds;                ///< of each: what round-off and unrest may have changed
  Eigen::MatrixXcd vectors;                  ///< of each
};

/// Of K with all its terms by their size: less is round-off.
inline constexpr double kZeroShare = 1e-11;

/// Sorts by rising |l|; of equal ones by their real parts.
void sort(Spectrum&);

/// Throws SolveError where M is not positive definite or the decomposition does not converge.
Spectrum spectrum_of(const QuadraticProblem&);

}  // namespace lockstep
