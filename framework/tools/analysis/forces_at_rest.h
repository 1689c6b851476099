// The forces on a mechanism at rest that nothing balances.
#pragma once

#include <algorithm>

#include <lockstep/dynamics.h>

namespace lockstep {

/// Forces at a state at rest: f - J^T lambda = M a with J a = 0.
class ForcesAtRest {
 public:
  explicit ForcesAtRest(Dynamics& dynamics) : dynamics_(dynamics), length_(dynamics.system().length()) {}

  /// Takes this state. Throws what an evaluation throws.
  void look(const State&);
  double power() const { return r.dot(a); }  ///< a^T M a

  const Evaluation* e = nullptr;
  VecX a, lambda, r, C;
  double unbalanced = 0,  ///< largest of r, relative
      force = 0,          ///< largest force on a body, N; moments by the length
      speed_up = 0;       ///< largest acceleration, m/s^2; turns by the length

 private:
  double largest(const VecX&) const;
  /// Of each force by itself, since all of them together vanish where nothing else holds a body.
  double largest_force();
  double size_of(const Vec6& f) const { return std::max(f.head<3>().norm(), f.tail<3>().norm() / length_); }

  Dynamics& dynamics_;
  double length_;
  ReactionIteration reacting_;
  VecX none_, Cd_, one_;
};

}  // namespace lockstep
