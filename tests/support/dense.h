// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// @file Decompositions of small dense matrices, compiled once for all tests.

#include <complex>
#include <vector>

#include <lockstep/math.h>

namespace lockstep::dense {

/// How many singular values are larger than `threshold` times the largest.
int rank(const MatX& A, double threshold);
/// The shortest x that minimises |A x - b|; pivots below `threshold` times the largest are zero.
VecX least_squares(const MatX& A, const VecX& b, double threshold);
/// An orthonormal basis of the null space, by columns, no column where there is none; pivots likewise.
MatX null_space(const MatX& A, double threshold);
/// Q of A = Q R, orthogonal.
MatX orthogonal(const MatX& A);
/// A^-1.
MatX inverse(const MatX& A);
/// A^-1 B.
MatX solve(const MatX& A, const MatX& B);
/// log |det A|.
double log_determinant(const MatX& A);
/// Of a real matrix.
std::vector<std::complex<double>> eigenvalues(const MatX& A);

}  // namespace lockstep::dense
