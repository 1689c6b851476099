// SPDX-License-Identifier: BSD-3-Clause
// NewtonMatrix: the saddle-point matrix of one Newton step of an implicit method, factored at a gathered state.
//
//   | a M + b D + c K   J^T | | x |   | f |      K, D: tangents of inertia, constraint and applied forces at lambda
//   | J                  -E | | l | = | r |      (TangentSum; theory, section 9); E: proximal term, corrected away
//
// An integrator with v' = v + h g al, q' = q (+) h v + h^2 b al takes a = 1, b = h g, c = h^2 b for the unknown al.
#pragma once

#include <complex>
#include <memory>

#include <lockstep/author/solver.h>
#include <lockstep/detail/rows.h>
#include <lockstep/dynamics.h>

namespace lockstep {

using VecXc = Eigen::VectorXcd;  ///< complex vector of any length

/// The matrix of one Newton step of an implicit method, gathered, factored and solved. Vectors have 6 numbers per slot
/// (force or translation in the world, moment or rotation in slot axes; components that a particle or a planar
/// mechanism lacks are ignored and are 0 in results), or 1 per row of the evaluation's table. It can hold a real and a
/// complex factor at once.
class LOCKSTEP_API NewtonMatrix {
 public:
  using Complex = std::complex<double>;  ///< scalar of the complex factor
  NewtonMatrix();                        ///< without numbers: call gather() first
  ~NewtonMatrix();

  /// Gathers M, J, K(lambda) and D at this evaluation; lambda: 1 per row. The symbolic work is done again when the
  /// description, the active joints or the pairs of the tangents changed; otherwise nothing is allocated. Earlier
  /// factors keep their numbers until factor() is called. Throws what the code of joints and forces throws.
  void gather(const Evaluation&, const VecX& lambda);

  /// Factors a M + b D + c K with the rows. Throws SolveError if the matrix is singular.
  void factor(double a, double b, double c);
  /// Factors the complex matrix; the real factor stays. Throws SolveError if the matrix is singular.
  void factor(Complex a, Complex b, Complex c);
  /// Solves by the last real factor; after a later gather() that is still the old matrix (simplified Newton). f, x: 6
  /// per slot; r, l: 1 per row.
  SolveReport solve(const VecX& f, const VecX& r, VecX& x, VecX& l);
  /// Solves by the last complex factor.
  SolveReport solve(const VecXc& f, const VecXc& r, VecXc& x, VecXc& l);

  /// Sets the residual up to which solve() corrects, relative to the terms of each equation: Newton's method needs few
  /// digits of a correction. Default: 1e-12.
  void set_residual(double enough);

  // -- products with the matrices gathered last; x: 6 per slot
  void add_M_times(const VecX& x, VecX& y) const;  ///< y += M x
  void add_D_times(const VecX& x, VecX& y) const;  ///< y += D x
  void add_K_times(const VecX& x, VecX& y) const;  ///< y += K x
  const TangentSum& tangents() const;              ///< K and D by pairs of slots

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace lockstep
