// SPDX-License-Identifier: BSD-3-Clause
// The functions of states.
#include "framework/hosts/c/state.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <lockstep/system.h>
#include <lockstep/text.h>

namespace lockstep::c {

void StateObject::require(May wanted) const {
  if (may >= wanted) return;
  refuse(LOCKSTEP_USAGE, wanted == May::change ? "this state may be read only; change a copy (lockstep_get_state)"
                                               : "this state cannot be evaluated; take a copy (lockstep_get_state)");
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
  if (given == wanted) return;
  refuse(LOCKSTEP_USAGE, "size is " + std::to_string(given) + "; must be " + std::to_string(wanted));
}
void check_given(const double* numbers, int count, const char* name) {
  const double* const end = numbers + count;
  const double* const bad = std::find_if_not(numbers, end, [](double x) { return std::isfinite(x); });
  if (bad != end)
    refuse(LOCKSTEP_USAGE,
           std::string(name) + "[" + std::to_string(bad - numbers) + "] is " + text::number(*bad) + "; must be finite");
}
// The length of the quaternion of a body, numbers[first] and the next three.
double length_of(const double* numbers, int first, const char* name, const Body& body) {
  const double* const e = numbers + first;
  const double length = std::hypot(std::hypot(e[0], e[1]), std::hypot(e[2], e[3]));
  if (length > 0 && std::isfinite(length)) return length;
  refuse(LOCKSTEP_USAGE, "body '" + body.name + "': its quaternion, " + name + "[" + std::to_string(first) + "] to [" +
                             std::to_string(first + 3) + "], has the length " + text::number(length) +
                             "; must be finite and above zero, with the scalar part first");
}

// q, v and s one after another.
template <class Part, class Numbers>
void each_part(Part& of, Numbers numbers, auto act) {
  for (VecX Part::*const part : {&Part::q, &Part::v, &Part::s}) act(of.*part, numbers), numbers += (of.*part).size();
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
    const double n = pose != nullptr ? length_of(pose, 3, "pose", body) : 1.0;
    s.change(May::change, [&](State& changed) {
      StateEditor edit(changed);
      if (pose != nullptr)
        edit.set_pose(
            body, {{pose[0], pose[1], pose[2]}, normalized(Quat{pose[3] / n, pose[4] / n, pose[5] / n, pose[6] / n})});
      if (twist != nullptr) edit.set_twist(body, {{twist[0], twist[1], twist[2]}, {twist[3], twist[4], twist[5]}});
    });
  });
}

int lockstep_sizes(const lockstep_state* state, double* t, int* n_q, int* n_v, int* n_s) {
  return call<StateObject, false>(state, [&](StateObject& object) {
    const State& s = object.in_slots();
    if (t != nullptr) *t = s.t;
    if (n_q != nullptr) *n_q = static_cast<int>(s.q.size());
    if (n_v != nullptr) *n_v = static_cast<int>(s.v.size());
    if (n_s != nullptr) *n_s = static_cast<int>(s.s.size());
  });
}

int lockstep_numbers(const lockstep_state* state, double* numbers, int size) {
  return call<StateObject, false>(state, [&](StateObject& object) {
    needed(numbers, "numbers");
    const State& s = object.in_slots();
    check_size(size, size_of(s));
    each_part(s, numbers, [](const VecX& part, double* to) { std::copy_n(part.data(), part.size(), to); });
  });
}

int lockstep_set_numbers(lockstep_state* state, double t, const double* numbers, int size) {
  return call<StateObject, false>(state, [&](StateObject& object) {
    needed(numbers, "numbers");
    object.change(May::change, [&](State& s) {
      const System& system = object.dynamics.system();
      check_size(size, size_of(s));
      check_given(numbers, size, "numbers"), check_given(&t, 1, "t");
      for (int k = 0; k < system.n_slots(); ++k) length_of(numbers, 7 * k + 3, "numbers", system.body_of_slot(k));
      if (object.may == May::change && t != s.t) refuse(LOCKSTEP_USAGE, "an event cannot change the time; give its own");
      s.t = t;
      each_part(s, numbers, [](VecX& part, const double* from) { std::copy_n(from, part.size(), part.data()); });
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
    check_finite(object.dynamics.system(), rate);
    each_part(rate, rates, [](const VecX& part, double* to) { std::copy_n(part.data(), part.size(), to); });
  });
}

int lockstep_move(lockstep_state* state, double h, const double* v, int size) {
  return call<StateObject>(state, [&](StateObject& object) {
    object.change(May::evaluate, [&](State& s) {
      check_given(&h, 1, "h");
      VecX along = s.v;
      if (v != nullptr) {
        check_size(size, static_cast<int>(along.size())), check_given(v, size, "v");
        std::copy_n(v, size, along.data());
      }
      object.dynamics.advance(s, h, along);
    });
  });
}

int lockstep_project(lockstep_state* state, double* violation) {
  return call<StateObject>(state, [&](StateObject& object) {
    ProjectReport report;
    object.change(May::evaluate, [&](State& s) { report = object.dynamics.project(s); });
    if (violation != nullptr) *violation = report.after;
  });
}
}
