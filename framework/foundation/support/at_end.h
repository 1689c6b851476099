// SPDX-License-Identifier: BSD-3-Clause
// An action at the end of a block.
#pragma once

#include <utility>

namespace lockstep {

/// Calls a function when it goes out of scope, also by an exception. The function must not throw.
template <class Act>
class [[nodiscard]] AtEnd {
 public:
  explicit AtEnd(Act act) : act_(std::move(act)) {}
  ~AtEnd() { act_(); }
  AtEnd(const AtEnd&) = delete;
  AtEnd& operator=(const AtEnd&) = delete;

 private:
  Act act_;
};

}  // namespace lockstep
