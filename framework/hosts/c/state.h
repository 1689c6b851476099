// SPDX-License-Identifier: BSD-3-Clause
// States as handles.
#pragma once

#include <memory>

#include <lockstep/dynamics.h>
#include <lockstep/state.h>
#include <lockstep/system.h>
#include "framework/hosts/c/handle.h"

namespace lockstep::c {

/// A state that a handle stands for.
class StateObject final : public Object {
 public:
  /// What may be done with it.
  enum class May {
    read,     ///< it belongs to a run
    change,   ///< also be changed, except its time
    evaluate  ///< also be evaluated
  };
  /// Its own copy.
  StateObject(State copy, Dynamics& by) : own_(std::move(copy)), state_(own_), dynamics(by), may(May::evaluate) {}
  /// One of the caller.
  StateObject(State& of, Dynamics& by, May its) : state_(of), dynamics(by), may(its) {}

  /// Throws LOCKSTEP_USAGE if that may not be done.
  void require(May) const;
  const State& given() const { return state_; }
  /// The same in the coordinates of the bodies; may be a copy, which is valid until the next call.
  const State& in_slots();
  /// Changes the state by `act` if that may be done and leaves finite numbers; else it stays and an error is thrown.
  template <class Act>
  void change(May by, Act&& act) {
    require(by);
    act(copy_ = state_);
    take_copy();
  }

 private:
  void take_copy();
  State own_, copy_;
  State& state_;

 public:
  Dynamics& dynamics;
  const May may;
};

/// A handle of a state for the time of a callback.
class Lent {
 public:
  /// A state that may be changed is not constant.
  Lent(const State& state, Dynamics& dynamics, StateObject::May may = StateObject::May::read)
      : object_(std::make_shared<StateObject>(const_cast<State&>(state), dynamics, may)),  // NOLINT
        handle_(static_cast<lockstep_state*>(new_handle(object_))) {}
  ~Lent() { remove_handle(handle_), object_->lock(); }
  Lent(const Lent&) = delete;
  Lent& operator=(const Lent&) = delete;
  lockstep_state* handle() const { return handle_; }

 private:
  std::shared_ptr<StateObject> object_;
  lockstep_state* handle_;
};

}  // namespace lockstep::c
