// SPDX-License-Identifier: BSD-3-Clause
// The functions of states.
#include "framework/hosts/c/state.h"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

namespace lockstep::c {

void StateObject::require(May wanted) const {
  if (may >= wanted) return;
  refuse(LOCKSTEP_USAGE, wanted == May::change ? "this state may be read only; change a copy (lockstep_get_state)"
                                               : "this state cannot be evaluated; take a copy (lockstep_get_state)");
}

// Throws LOCKSTEP_NON_FINITE, by the name of a body, if numbers of a state or of its rates are not finite.
static void check_finite(const System& system, const VecX& q, const VecX& v, const VecX& s) {
  constexpr const char* kAdvice = " gets a number that is not finite; look at the state and step that were given";
  for (int k = 0; k < system.n_slots(); ++k)
    if (!q.segment<7>(7 * k).allFinite() || !v.segment<6>(6 * k).allFinite())
      refuse(LOCKSTEP_NON_FINITE, "body '" + system.body_of_slot(k).name + "'" + kAdvice);
  if (!s.allFinite()) refuse(LOCKSTEP_NON_FINITE, std::string("an integrated state") + kAdvice);
}

void StateObject::take_copy() {
  const System& system = dynamics.system();
  for (int k = 0; k < system.n_slots(); ++k)
    if (!std::isnormal(copy_.q.segment<4>(7 * k + 3).squaredNorm()))
      refuse(LOCKSTEP_USAGE, "body '" + system.body_of_slot(k).name +
                                 "': its quaternion has no length; must be finite and above zero, scalar part first");
  check_finite(system, copy_.q, copy_.v, copy_.s);
  state_ = copy_;
}

const State& StateObject::in_slots() {
  if (state_.coordinates == nullptr) return state_;
  return copy_ = dynamics.in_slots(state_);
}

}  // namespace lockstep::c

using namespace lockstep;
using namespace lockstep::c;

namespace {

using May = StateObject::May;

int size_of(const State& s) { return static_cast<int>(s.q.size() + s.v.size() + s.s.size()); }

void check_size(int given, int wanted) {
  if (given != wanted) refuse(LOCKSTEP_USAGE, fmt::format("size is {}; must be {}", given, wanted));
}

}  // namespace

extern "C" {

int lockstep_body(const lockstep_state* state, const char* name, double* pose, double* twist) {
  return call<StateObject, false>(state, [&](StateObject& s) {
    const Body& body = s.dynamics.system().body(needed_text(name, "name"));
    if (pose != nullptr) {
      const Pose at = body_pose(body, s.given());
      std::copy_n(at.x.data(), 3, pose), pose[3] = at.q.w, pose[4] = at.q.x, pose[5] = at.q.y, pose[6] = at.q.z;
    }
    if (twist != nullptr) {
      const Twist of = body_twist(body, s.given());
      std::copy_n(of.v.data(), 3, twist), std::copy_n(of.w.data(), 3, twist + 3);
    }
  });
}

int lockstep_set_body(lockstep_state* state, const char* name, const double* pose, const double* twist) {
  return call<StateObject, false>(state, [&](StateObject& s) {
    const Body& body = s.dynamics.system().body(needed_text(name, "name"));
    if (pose != nullptr) check_given(pose, 7, "pose");
    if (twist != nullptr) check_given(twist, 6, "twist");
    s.change(May::change, [&](State& changed) {
      StateEditor edit(changed);
      if (pose != nullptr)
        edit.set_pose(body, {{pose[0], pose[1], pose[2]}, normalized(Quat{pose[3], pose[4], pose[5], pose[6]})});
      if (twist != nullptr) edit.set_twist(body, {{twist[0], twist[1], twist[2]}, {twist[3], twist[4], twist[5]}});
    });
  });
}

int lockstep_sizes(const lockstep_state* state, double* t, int* n_q, int* n_v, int* n_s) {
  return call<StateObject, false>(state, [&](StateObject& object) {
    const State& s = object.in_slots();
    put(t, s.t), put(n_q, s.q.size()), put(n_v, s.v.size()), put(n_s, s.s.size());
  });
}

int lockstep_numbers(const lockstep_state* state, double* numbers, int size) {
  return call<StateObject, false>(state, [&](StateObject& object) {
    needed(numbers, "numbers");
    const State& s = object.in_slots();
    check_size(size, size_of(s));
    Eigen::Map<VecX>(numbers, size) << s.q, s.v, s.s;
  });
}

int lockstep_set_numbers(lockstep_state* state, double t, const double* numbers, int size) {
  return call<StateObject, false>(state, [&](StateObject& object) {
    needed(numbers, "numbers");
    object.change(May::change, [&](State& s) {
      check_size(size, size_of(s));
      check_given(numbers, size, "numbers"), check_given(&t, 1, "t");
      if (object.may == May::change && t != s.t)
        refuse(LOCKSTEP_USAGE, "an event cannot change the time; give its own");
      const Eigen::Map<const VecX> all(numbers, size);
      s.t = t, s.q = all.head(s.q.size()), s.v = all.segment(s.q.size(), s.v.size()), s.s = all.tail(s.s.size());
    });
  });
}

int lockstep_rates(const lockstep_state* state, double* rates, int size) {
  return call<StateObject>(state, [&](StateObject& object) {
    needed(rates, "rates");
    object.require(May::evaluate);
    check_size(size, size_of(object.given()));
    StateRate rate = sized_like(object.given());
    object.dynamics.rate(object.given(), rate);
    check_finite(object.dynamics.system(), rate.q, rate.v, rate.s);
    Eigen::Map<VecX>(rates, size) << rate.q, rate.v, rate.s;
  });
}

int lockstep_move(lockstep_state* state, double h, const double* v, int size) {
  return call<StateObject>(state, [&](StateObject& object) {
    object.change(May::evaluate, [&](State& s) {
      check_given(&h, 1, "h");
      VecX along = s.v;
      if (v != nullptr) check_size(size, static_cast<int>(along.size())), check_given(v, size, "v");
      if (v != nullptr) along = Eigen::Map<const VecX>(v, size);
      object.dynamics.advance(s, h, along);
    });
  });
}

int lockstep_project(lockstep_state* state, double* violation) {
  return call<StateObject>(state, [&](StateObject& object) {
    ProjectReport report;
    object.change(May::evaluate, [&](State& s) { report = object.dynamics.project(s); });
    put(violation, report.after);
  });
}
}
