// Explicit Runge-Kutta: the tableau as data, and the stages of one step.
//
//   k_i = f(t + c_i h, y + h sum_j a_ij k_j),  y1 = y + h sum_i b_i k_i,  y = (q, v, s)
//
// In the stages quaternions go by their plain rates e' = e (0, w)/2; the end of the step is put back on the unit
// sphere.
#pragma once

#include <vector>

#include "framework/dynamics/dynamics.h"

namespace lockstep {

/// Coefficients of a method; the arrays live as long as the program.
struct Tableau {
  int order = 1;
  int n_stages = 1;           ///< of a step
  int n_all = 1;              ///< with those that only dense output needs
  int stride = 1;             ///< numbers in a row of `a`
  const double* a = nullptr;  ///< n_all rows, those above the diagonal are not read
  const double* b = nullptr;
  const double* c = nullptr;
};

class LOCKSTEP_API Stages {
 public:
  /// Sizes everything; the only place that allocates.
  void begin(const Tableau&, const State&);
  /// k_first ... k_(last - 1) of a step of h from y; the earlier ones stand.
  void evaluate(Dynamics&, const State& y, double h, int first, int last);
  /// out = y + h sum_i w_i k_i over the first n, and the time y.t + h; memory and links stay as they are in `out`.
  void combine(const State& y, double h, const double* w, int n, State& out) const;
  /// out = h sum_i w_i k_i over the first n.
  void sum(double h, const double* w, int n, StateRate& out) const;
  const StateRate& k(int i) const { return k_[static_cast<std::size_t>(i)]; }

 private:
  Tableau tableau_;
  State stage_;
  std::vector<StateRate> k_;
};

/// Ends a step: unit quaternions, then onto the constraints where the dynamics says so. `before` and `after` are |C|,
/// m.
ProjectReport land(Dynamics&, State&);
/// The same for a method that cannot reject: StepError when the projection does not converge.
ProjectReport land_or_throw(Dynamics&, State&, const char* method, double t, double h);

/// Scratch of the size of a state.
LOCKSTEP_API StateRate sized_like(const State&);
/// out = in, without the links' set and the memory, which do not change during a step.
void copy_motion(const State& in, State& out);

}  // namespace lockstep
