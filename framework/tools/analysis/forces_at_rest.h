// SPDX-License-Identifier: BSD-3-Clause
// The forces on a mechanism at rest that nothing balances, and what friction carries of them.
#pragma once

#include <array>

#include <lockstep/dynamics.h>
#include "framework/tools/analysis/rest_matrices.h"

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
      speed_up = 0;       ///< largest acceleration, m/s^2; rotations by the length

 private:
  double largest(const VecX&) const;

  Dynamics& dynamics_;
  double length_;
  ReactionIteration reacting_;
  VecX none_, Cd_;
};

/// J^T lambda of those rows of an entry that `takes` chooses, by their place in it, on its i-th slot.
template <class Takes>
Vec6 load_of(const RowTable& table, const RowEntry& entry, int i, const VecX& lambda, Takes&& takes) {
  Vec6 sum = Vec6::Zero();
  for (int k = 0; k < entry.m; ++k) {
    if (!takes(k)) continue;
    const std::array<double, 6> J = table.block(entry).J(i, k);
    sum += lambda[entry.first_row + k] * Eigen::Map<const Vec6>(J.data());
  }
  return sum;
}

/// The largest single load on each slot, N: its weight, each applied force and their sum, the reaction of a link;
/// moments by the length. Each by itself, since all of them together vanish if nothing else holds a body.
VecX largest_loads(const Evaluation&, const VecX& lambda);

/// Forces of friction that balance the forces which the rows leave.
struct FrictionLoad {
  bool balances = false;          ///< whether there are any, however large; the rest is only then filled in
  bool holds = false;             ///< whether some are within their limits
  std::vector<GripReport> grips;  ///< what each carries, and its limit under the reactions there
  VecX lambda;                    ///< multipliers, 1 per row
  MatX ungripped;                 ///< free motions that no friction holds, in the unknowns of the matrices
};

/// Whether friction acts on any motion.
bool has_friction(const ForcesAtRest&);
/// The least forces of friction, each divided by its limit, that balance the forces at this state. If those are beyond a
/// limit, the ones whose largest share of a limit is least. Requires has_friction().
FrictionLoad friction_load(Dynamics&, const ForcesAtRest&, const RestMatrices&);

}  // namespace lockstep
