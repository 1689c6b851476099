// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/params/input_scope.h"

#include <utility>

namespace lockstep {

namespace {
thread_local const InputScope* innermost = nullptr;
}

InputScope::InputScope(Find find) : find_(std::move(find)), outer_(std::exchange(innermost, this)) {}
InputScope::~InputScope() { innermost = outer_; }

InputScope::Reader InputScope::find(const std::string& name, double value) {
  if (innermost == nullptr) return [value] { return value; };
  return innermost->find_(name, value);
}

}  // namespace lockstep
