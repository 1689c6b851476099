// LinearizedMotion: y' = f(y) of the increments of a step, linearised at one state, and solved for implicit methods.
//
//   (g - f') dy = r:   g dq - dv = r_q,   g dv - al = r_v,   g ds = r_s,
//                      M al + D dv + K dq + Jh^T l = 0,   Jh al = 0
//
// K, D: tangents of forces and constraints (theory, section 9). What the rows' right side changes with q and v is left
// out (9.15), and so is what the states s do to one another and to the forces: Newton then takes an iteration more.
#pragma once

#include "framework/dynamics/evaluate/dynamics.h"
#include "framework/dynamics/evaluate/implicit.h"

namespace lockstep {

class LOCKSTEP_API LinearizedMotion {
 public:
  using Complex = NewtonMatrix::Complex;
  /// Sizes the scratch for states like this one.
  void begin(const State&);
  /// Linearised at this solution. Throws NonFiniteError, SolveError.
  void gather(const Solution&);
  /// Factors of the matrix for g; a real and a complex one live side by side.
  void factor(double g);
  void factor(Complex g);
  /// y = (g - f')^-1 r by the factor for this g.
  void solve(double g, const VecX& r, VecX& y);
  void solve(Complex g, const VecX& r_re, const VecX& r_im, VecX& y_re, VecX& y_im);

 private:
  NewtonMatrix matrix_;
  VecX p_, p_im_, force_, force_im_, rows_, al_, l_;  // 6 a slot, one a row
  VecXc force_c_, rows_c_, al_c_, l_c_;
};

}  // namespace lockstep
