// NewtonMatrix: the saddle-point matrix of one Newton step of an implicit method, factored at a gathered state.
//
//   | a M + b D + c K   J^T | | x |   | f |      K, D: tangents of inertia, constraint and applied forces at lambda
//   | J                  -E | | l | = | r |      (TangentSum; theory, section 9); E: proximal term, corrected away
//
// An integrator with v' = v + h g al, q' = q (+) h v + h^2 b al takes a = 1, b = h g, c = h^2 b for the unknown al.
#pragma once

#include <complex>
#include <memory>

#include <lockstep/dynamics.h>
#include <lockstep/rows.h>
#include <lockstep/solver.h>

namespace lockstep {

using VecXc = Eigen::VectorXcd;

/// Vectors: 6 a slot (force or translation in the world, moment or turn in slot axes; what a particle or a planar
/// mechanism does not have is ignored and comes out 0), one a row of the dynamics' table. A real and a complex factor
/// may live side by side.
class LOCKSTEP_API NewtonMatrix {
 public:
  using Complex = std::complex<double>;
  NewtonMatrix();
  ~NewtonMatrix();

  /// M, J, K(lambda) and D at this evaluation; lambda: 1 per row. The symbolic work is done anew when the description, the links in force or the pairs of the tangents changed;
  /// otherwise nothing is allocated. Earlier factors keep their numbers until factor() is called.
  void gather(const Evaluation&, const VecX& lambda);

  /// Throws SolveError when the matrix is singular.
  void factor(double a, double b, double c);
  void factor(Complex a, Complex b, Complex c);
  /// By the last factor of this scalar; after a later gather() with the old matrix still (simplified Newton).
  SolveReport solve(const VecX& f, const VecX& r, VecX& x, VecX& l);
  SolveReport solve(const VecXc& f, const VecXc& r, VecXc& x, VecXc& l);

  /// Residuals that solve() lets stand, relative to the terms of their equation: Newton's method needs few digits of a
  /// correction. At first 1e-12.
  void set_residual(double enough);

  /// How often a body's own block had no pivot, so that the block factorisation gave way to a dense one (which
  /// allocates): statics and singular poses.
  long n_dense() const;

  // -- products with what was gathered last: y += M x, D x, K x, J x, J^T l
  void add_M_times(const VecX& x, VecX& y) const;
  void add_D_times(const VecX& x, VecX& y) const;
  void add_K_times(const VecX& x, VecX& y) const;
  void add_J_times(const VecX& x, VecX& y) const;
  void add_Jt_times(const VecX& l, VecX& y) const;
  const TangentSum& tangents() const;

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace lockstep
