// Poses and twists of bodies in a state, read and set whatever coordinates the state keeps.
#pragma once

#include "framework/mechanism/model/body.h"
#include "framework/mechanism/model/state.h"

namespace lockstep {

/// Pose of a body's frame in the world, m.
LOCKSTEP_API Pose pose(const Body&, const State&);
/// v: velocity of the origin of the body's frame, m/s, world; w: rad/s, the body's axes.
LOCKSTEP_API Twist twist(const Body&, const State&);

/// For user code that changes a state: Event::change, a start for Simulation::set_state. What was set need not fit the
/// links; who takes the state makes it consistent. Bodies that are merged into one move together.
class LOCKSTEP_API StateEditor {
 public:
  explicit StateEditor(State& state) : state_(state) {}
  Pose pose(const Body& body) const { return lockstep::pose(body, state_); }
  Twist twist(const Body& body) const { return lockstep::twist(body, state_); }
  /// Puts the body's frame there; its twist stays. Throws ModelError for a body that does not move.
  void set_pose(const Body&, const Pose&);
  void set_twist(const Body&, const Twist&);

 private:
  State& state_;
};

}  // namespace lockstep
