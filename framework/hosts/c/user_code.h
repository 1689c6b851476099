// SPDX-License-Identifier: BSD-3-Clause
// Callbacks with their user data, and the messages with which they fail.
#pragma once

#include "framework/hosts/c/lockstep/c.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/error.h>
#include "framework/foundation/support/at_end.h"

namespace lockstep::c {

/// User data, freed with the last callback that has it.
using User = std::shared_ptr<void>;

/// Calls `act` with user data that is freed in any case.
template <class Act>
int with_user(void* user, lockstep_free_user free_user, Act act) noexcept {
  try {
    return act(User(user, [free_user](void* data) {
      if (free_user != nullptr) free_user(data);
    }));
  } catch (...) {
    return LOCKSTEP_MEMORY;
  }
}

/// The message of the callback in progress in this thread; null: there is none.
extern thread_local std::string* message_in_progress;

/// Calls a callback that may stop the run: whether it goes on. Throws UserCodeError with the callback's message.
template <class F, class... Args>
bool goes_on(F callback, Args... args) {
  std::string message;
  const AtEnd restore([outer = std::exchange(message_in_progress, &message)] { message_in_progress = outer; });
  const int result = callback(args...);
  if (result != 0 && result != LOCKSTEP_STOP)
    throw UserCodeError(message.empty()
                            ? "the callback returned " + std::to_string(result) + " " + lockstep_code_name(result)
                            : message);
  return result == 0;
}

/// Calls one that may not.
template <class F, class... Args>
void invoke(F callback, Args... args) {
  if (!goes_on(callback, args...))
    throw UserCodeError("the callback returned LOCKSTEP_STOP, which only observers may; return 0");
}

/// A callback of a type with the values of its keys.
template <class F>
struct Code {
  F callback;
  User user;
  std::vector<double> values;

  template <class... Args>
  void operator()(Args... args) const {
    invoke(callback, user.get(), values.data(), args...);
  }
};

}  // namespace lockstep::c
