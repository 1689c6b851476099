// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/state.h>

#include <lockstep/error.h>
#include "framework/mechanism/model/read_motion.h"

namespace lockstep {

Coordinates::~Coordinates() = default;

void State::refuse_setting() const {
  throw ModelError("a pose or twist cannot be set in a state in coordinates of the formulation '" +
                   std::string(coordinates->name()) + "'; convert it first (Dynamics::to_slots)");
}

Pose State::slot_pose(int slot) const {
  if (coordinates) {
    const Motion m = coordinates->motion(*this, slot);
    return {m.x, m.e};
  }
  return {q.segment<3>(7 * slot), Quat::from(q.segment<4>(7 * slot + 3))};
}

Twist State::slot_twist(int slot) const {
  if (coordinates) {
    const Motion m = coordinates->motion(*this, slot);
    return {m.v, m.w};
  }
  return {v.segment<3>(6 * slot), v.segment<3>(6 * slot + 3)};
}

void State::set_slot_pose(int slot, const Pose& p) {
  if (coordinates) refuse_setting();
  q.segment<3>(7 * slot) = p.x;
  q.segment<4>(7 * slot + 3) = p.q.coefficients();
}

void State::set_slot_twist(int slot, const Twist& o) {
  if (coordinates) refuse_setting();
  v.segment<3>(6 * slot) = o.v;
  v.segment<3>(6 * slot + 3) = o.w;
}

Motion slot_motion(const State& state, int slot) {
  Motion out;
  if (slot != kGround) read_motion(state, slot, out);
  return out;
}

void put_state(const State& state, Snapshot& out) {
  out.put(state.t);
  for (const VecX* x : {&state.q, &state.v, &state.s, &state.z}) out.put_all(*x);
  out.put_all(state.modes), out.put_all(state.watched);
}

void get_state(State& state, SnapshotReader& in) {
  state.t = in.get();
  for (VecX* x : {&state.q, &state.v, &state.s, &state.z}) in.get_all(*x);
  in.get_all(state.modes), in.get_all(state.watched);
}

namespace {

// Numbers of another count would be written past.
void check(const State& state, const VecX& v, const char* what) {
  const auto n_q = state.coordinates ? state.coordinates->n_q() : 7 * (state.q.size() / 7);
  const auto n_v = state.coordinates ? state.coordinates->n_v() : 6 * (state.q.size() / 7);
  if (state.q.size() != n_q || v.size() != n_v)
    throw ModelError(std::string(what) + ": a state of " + std::to_string(state.q.size()) +
                     " coordinates does not fit " + std::to_string(v.size()) +
                     " velocities; begin from System::start()");
}

}  // namespace

void advance_state(State& state, double h, const VecX& v) {
  check(state, v, "advance_state");
  if (state.coordinates) return state.coordinates->advance(state, h, v);
  for (int k = 0; 6 * k < v.size(); ++k) {
    state.q.segment<3>(7 * k) += h * v.segment<3>(6 * k);
    const Quat q = Quat::from(state.q.segment<4>(7 * k + 3)) * exponential(Vec3(h * v.segment<3>(6 * k + 3)));
    state.q.segment<4>(7 * k + 3) = q.coefficients();
  }
}

void normalize_state(State& state) {
  check(state, state.v, "normalize_state");
  if (state.coordinates) return state.coordinates->normalize(state);
  for (int k = 0; 7 * k < state.q.size(); ++k) state.q.segment<4>(7 * k + 3).normalize();
}

void kinematic_rate(const State& state, VecX& qd) {
  check(state, state.v, "kinematic_rate");
  if (state.coordinates) return state.coordinates->kinematic_rate(state, qd);
  qd.resize(state.q.size());
  for (int k = 0; 7 * k < state.q.size(); ++k) {
    const Quat q = Quat::from(state.q.segment<4>(7 * k + 3));
    qd.segment<3>(7 * k) = state.v.segment<3>(6 * k);
    qd.segment<4>(7 * k + 3) = rate(q, Vec3(state.v.segment<3>(6 * k + 3))).coefficients();
  }
}

StateRate sized_like(const State& y) {
  StateRate rate;
  size_like(y, rate);
  return rate;
}

void size_like(const State& y, StateRate& out) {
  const auto followed = y.coordinates ? static_cast<Eigen::Index>(y.coordinates->followed().size()) : 0;
  out.q.setZero(y.q.size()), out.v.setZero(y.v.size()), out.s.setZero(y.s.size());
  out.followed.setZero(12 * followed);
  out.largest_a = out.largest_alpha = 0;
}

}  // namespace lockstep
