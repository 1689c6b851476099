// SPDX-License-Identifier: BSD-3-Clause
// Refusals: several errors of one input as one.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <lockstep/error.h>

namespace lockstep {

/// What is wrong with an input, a line each; of more than twenty lines the first. Repeated lines are given once.
class LOCKSTEP_API Refusals {
 public:
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
  std::vector<std::string> lines_;
  ErrorData first_;
};

}  // namespace lockstep
