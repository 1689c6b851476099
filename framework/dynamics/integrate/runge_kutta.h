// Stages: those of one step of an explicit Runge-Kutta method, for every method that brings a tableau.
//
//   k_i = f(t + c_i h, y + h sum_j a_ij k_j),  y1 = y + h sum_i b_i k_i,  y = (q, v, s)
//
// In the stages quaternions follow their plain rates e' = e (0, w)/2; the end of the step is normalised.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "framework/dynamics/evaluate/dynamics.h"
#include "framework/dynamics/integrate/tableau.h"
#include "framework/foundation/support/error.h"

namespace lockstep {

/// Where the equations of motion are evaluated: at the stage as it is, or at its projection onto the constraints. The
/// field f(P(y)) equals f on the constraints and is smooth across singular positions; it costs about twice as much.
enum class StagesOn { plain, manifold };

/// Conditioning of one evaluation: near a singular position the accelerations come from what is left of vanishing
/// pivots.
struct Conditioning {
  double detector = std::numeric_limits<double>::infinity();  ///< of SolveReport; infinite where the solver has none
  double pivot = std::numeric_limits<double>::infinity();     ///< smallest
  double residual = 0;
  /// How far from singular. Without a detector: the smallest pivot, which redundant rows make small everywhere.
  double indicator() const { return detector < std::numeric_limits<double>::infinity() ? detector : pivot; }
};

class LOCKSTEP_API Stages {
 public:
  /// Sizes everything; the only place that allocates. `watch`: conditioning() is needed, which costs the solver time.
  void begin(const Tableau&, const State&, bool watch = false);
  /// k_first ... k_(last - 1) of a step of h from y; the earlier ones are kept. False: a stage could not be brought
  /// onto the constraints.
  bool evaluate(Dynamics&, const State& y, double h, int first, int last, StagesOn on = StagesOn::plain);
  /// out = y + h sum_i w_i k_i and the time y.t + h; memory and links stay as they are in `out`.
  void combine(const State& y, double h, const Weights& w, State& out) const;
  /// out = h sum_i w_i k_i.
  void sum(double h, const Weights& w, StateRate& out) const;
  /// The end of the step: combine() with b.
  void end(const State& y, double h, State& out) const { combine(y, h, b_, out); }
  const StateRate& k(int i) const { return k_[static_cast<std::size_t>(i)]; }
  /// Puts the rates of stage i, known by other means.
  void put(int i, const StateRate& k);
  /// Of stage i when watched; else perfect.
  const Conditioning& conditioning(int i) const { return conditioning_[static_cast<std::size_t>(i)]; }
  /// Singularity indicator of the step: the smallest of its stages.
  double indicator() const;

 private:
  Tableau tableau_;
  std::vector<Weights> a_;
  Weights b_;
  State stage_;
  std::vector<StateRate> k_;
  bool watch_ = false;
  std::array<Conditioning, Weights::kMost> conditioning_{};
};

/// Puts the end of a step on the constraints: unit quaternions, then the projection where the dynamics says so, to
/// round-off when the stages are on the constraints too. `before` and `after` are |C|, m.
LOCKSTEP_API ProjectReport project_end(Dynamics&, State&, StagesOn on = StagesOn::plain);
/// The same for a method that cannot reject: StepError when the projection does not converge.
LOCKSTEP_API ProjectReport project_end_or_throw(Dynamics&, State&, const char* method, double t, double h,
                                                StagesOn on = StagesOn::plain);
/// The error of a step of h from t whose end could not be projected.
LOCKSTEP_API StepError end_not_projected(const ProjectReport&, const std::string& method, double t, double h);
/// One error from the estimates of two orders: e5^2 / sqrt(e5^2 + 0.01 e3^2), Hairer, Norsett & Wanner 1993, II.10.
LOCKSTEP_API double combined_error(double e5, double e3);

/// Scratch of the size of a state.
LOCKSTEP_API StateRate sized_like(const State&);
/// out = in, without the links' set and the memory, which do not change during a step.
LOCKSTEP_API void copy_motion(const State& in, State& out);
/// The same by exchange: `in` is scratch afterwards.
LOCKSTEP_API void take_motion(State& in, State& out);

}  // namespace lockstep
