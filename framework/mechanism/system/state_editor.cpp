// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/system.h>

#include <algorithm>
#include <string>

#include <lockstep/error.h>

namespace lockstep {

namespace {

int moving_slot(const Body& b) {
  if (b.slot == kGround)
    throw ModelError("body '" + b.name + "' does not move; only moving bodies have a pose or twist to set");
  return b.slot;
}

// A state of fewer bodies would be read past its end.
void check_has(const State& state, const Body& b) {
  Eigen::Index n = std::min(state.q.size() / 7, state.v.size() / 6);
  if (const Coordinates* own = state.coordinates.get())
    n = state.q.size() == own->n_q() && state.v.size() == own->n_v() ? own->n_slots() : 0;
  if (b.slot >= n)
    throw ModelError("a state of " + std::to_string(n) + " moving bodies does not hold body '" + b.name +
                     "'; begin from System::start() once the system is complete");
}

}  // namespace

Pose body_pose(const Body& b, const State& state) {
  if (b.slot == kGround) return b.home;
  check_has(state, b);
  const Pose slot = state.slot_pose(b.slot);
  return Pose{slot.x, normalized(slot.q)} * b.in_slot;
}

Twist body_twist(const Body& b, const State& state) {
  if (b.slot == kGround) return {};
  check_has(state, b);
  const Twist slot = state.slot_twist(b.slot);
  const Mat3 A = rotation(normalized(state.slot_pose(b.slot).q));
  return {slot.v + A * cross(slot.w, b.in_slot.x), rotation(b.in_slot.q).transpose() * slot.w};
}

void StateEditor::set_pose(const Body& b, const Pose& pose) {
  const int slot = moving_slot(b);
  const Twist kept = twist(b);
  state_.set_slot_pose(slot, Pose{pose.x, normalized(pose.q)} * inverse(b.in_slot));
  set_twist(b, kept);
}

void StateEditor::set_twist(const Body& b, const Twist& twist) {
  const int slot = moving_slot(b);
  check_has(state_, b);
  const Vec3 w = rotation(b.in_slot.q) * twist.w;
  const Mat3 A = rotation(normalized(state_.slot_pose(slot).q));
  state_.set_slot_twist(slot, {twist.v - A * cross(w, b.in_slot.x), w});
}

}  // namespace lockstep
