// SPDX-License-Identifier: BSD-3-Clause
// One search for an equilibrium: Newton's method, dynamic relaxation if that fails, one-sided joints.
#pragma once

#include <string>
#include <vector>

#include <lockstep/detail/newton.h>
#include <lockstep/equilibrium.h>
#include "framework/dynamics/simulate/contacts.h"
#include "framework/foundation/math/limits.h"
#include "framework/tools/analysis/forces_at_rest.h"

namespace lockstep {

/// A state at rest, and what was found of it.
struct AtRest {
  State& state;
  EquilibriumReport& report;
};

/// Ends a look in space: where all of `found` lie in the plane, as `start` does, the system goes back to it, with their
/// multipliers; else it stays in space.
void go_back_to_plane(Dynamics&, System::InSpace& look, const State& start, const std::vector<AtRest>& found);

/// A search from one state, which it moves. All must outlive it.
class EquilibriumSearch {
 public:
  EquilibriumSearch(Dynamics&, State&, const EquilibriumOptions&, EquilibriumReport&);
  /// Ends at rest, or throws SolveError.
  void run();

 private:
  /// Onto the rows, without velocities. False if that fails: too far off, or outside of where a law or function of a
  /// link is defined.
  bool settle(State& state);

  // -- Newton's method

  double least_shift() const;
  /// A step of Newton's method that goes with the forces, unless `either_way`, and is not too long. False if there is
  /// none.
  bool find_step(bool either_way);
  /// In the free motions, K u = mu M u: against each stiffness by its size, so that the step goes downhill where K is
  /// not positive too; `either_way`: against each as it is. What nothing holds and nothing pushes stays.
  bool find_dense_step(bool either_way);
  /// (K + s M) dx + J^T dl = r, J dx = -C. s grows until the step goes with the forces and is short enough.
  bool find_sparse_step(bool either_way);
  bool accepts(double slope_before, double unbalanced_before, double power_before) const;
  /// The largest rotation, rad, or move by the extent of the mechanism.
  double size_of(const VecX& step) const;
  /// Looks at the present state. False if its forces are not finite.
  bool look();
  /// One step along the line. False if no share of it is accepted; the state is then the old one.
  bool take_step();
  /// At most so many steps, which are added to those made.
  bool newton(int& made, int most);

  // -- friction

  /// Whether friction holds the present state, and motions without friction are stable; if so, it is reported.
  bool rests_by_friction();
  /// The loads beyond the friction of the given state, in a sentence; "" if there are none.
  std::string beyond_friction() const;

  // -- dynamic relaxation

  /// The same steps with a shift s that begins at what the forces accelerate, and with the sparse matrix: the motion of
  /// masses without inertia, M dx/dt = r, in implicit steps of 1/s that grow as it comes to rest.
  void relax();
  bool gone() const;
  [[noreturn]] void no_equilibrium();

  // -- unstable positions

  /// Leaves one along the motion that grows.
  void push_off(const FreeMotion& motion);

  // -- one-sided joints

  std::size_t most_releases() const { return 200 + 4 * contacts_.size(); }
  /// Puts into force those that the state passes through, or touches. Returns whether there were any.
  bool touch(State& state);
  double push(std::size_t i) const;
  /// Whether its load would have to pull.
  bool pulls(std::size_t i) const {
    return contacts_.in_force(i, state_) && contacts_.watched(i, state_) && push(i) < -kNegligible * now_.force;
  }
  /// Releases the joint that pulls most. Returns whether one did.
  bool release();
  std::vector<std::string> contact_names() const;

  /// Whether a law moves it at this time, and a force acts on it.
  bool moves_under_force(const Marker& marker) const;
  void finish();

  Dynamics& dynamics_;
  const System& system_;
  State& state_;
  const EquilibriumOptions& options_;
  EquilibriumReport& report_;
  ForcesAtRest now_;
  Contacts contacts_;
  NewtonMatrix matrix_;
  State start_;
  VecX step_, turned_;
  double length_, extent_ = 0, heaviest_ = 0, shift_ = 0, slope_ = 0;
  std::size_t releases_ = 0;
  int released_at_ = -1;
};

}  // namespace lockstep
