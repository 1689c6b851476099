// The unknown velocities of a mechanism as columns of its matrices.
#pragma once

#include <array>
#include <vector>

#include <lockstep/linearization.h>

namespace lockstep {

/// Where the six velocities of each slot are among the unknowns.
class Unknowns {
 public:
  explicit Unknowns(const System&);

  int n() const { return n_; }
  /// Column of a velocity of a slot; -1 where it is none of the unknowns: a particle's turns, what leaves a plane.
  int column(int slot, int velocity) const {
    return at_[static_cast<std::size_t>(slot)][static_cast<std::size_t>(velocity)];
  }
  std::vector<UnknownVelocity> names(const System&) const;
  /// The unknowns among six numbers a slot.
  VecX of_slots(const VecX& six) const;
  /// Six numbers a slot, zero where there is no unknown.
  VecX to_slots(const VecX& unknowns) const;

 private:
  std::vector<std::array<int, 6>> at_;
  int n_ = 0;
};

/// The bodies of a slot: "arm + bob".
std::string bodies_of(const Slot&);

/// What the unrest of a still state may add to w^2, 1/s^2; frozen coefficients are those of their instant.
inline double unrest_share(const LinearMotion& m) {
  return m.unrest.is_still() ? m.unrest.acceleration / m.length : 0.0;
}

/// K of the mechanism at a state with these multipliers, 1 per row; in axes that do not turn.
SparseMat stiffness_with(Dynamics&, const State&, const VecX& lambda);

}  // namespace lockstep
