// SPDX-License-Identifier: BSD-3-Clause
// Refusals: several errors of one input as one.
#pragma once

#include <map>
#include <string>
#include <utility>

#include <lockstep/error.h>

namespace lockstep {

/// What is wrong with an input, a line each, in the order of its lines; of more than twenty the first. Repeated lines are
/// given once.
class LOCKSTEP_API Refusals {
 public:
  /// Errors without a key are about this one, from now on.
  Refusals& about(const std::string& key) { return key_ = key, *this; }
  /// Runs `act`, and keeps its error.
  template <class F>
  void attempt(F&& act) {
    try {
      std::forward<F>(act)();
    } catch (const SceneError& error) {
      add(error);
    }
  }
  void add(const SceneError&);
  bool empty() const { return lines_.empty(); }
  bool full() const;
  /// Throws one SceneError of all, with the data of the first; does nothing where there is none.
  void raise() const;

 private:
  std::multimap<int, std::string> lines_;  // by their place in the input
  std::string key_;
  ErrorData first_;
};

}  // namespace lockstep
